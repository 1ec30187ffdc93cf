//! Vectors of plain numbers: [`Vector`].

/// A vector of the scaled velocity space (x, y, ρ θ), or of (x, y, ρ θ, y) with the pusher's yield
/// speed appended.
pub type Vector<const N: usize> = [f64; N];

/// a · b.
pub fn dot<const N: usize>(a: &Vector<N>, b: &Vector<N>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a + s b.
pub fn add_scaled<const N: usize>(a: &Vector<N>, s: f64, b: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|i| a[i] + s * b[i])
}

/// Length of a vector.
pub fn norm<const N: usize>(a: &Vector<N>) -> f64 {
    dot(a, a).sqrt()
}

/// (v_x, v_y, ρ ω) of (v, y).
pub fn velocity(v: &Vector<4>) -> Vector<3> {
    [v[0], v[1], v[2]]
}
