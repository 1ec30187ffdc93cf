//! The vector instructions that a benchmark compares.

use stickslip_dynamics::Level;

/// The widest instructions of this machine and, where these are AVX-512, AVX2 too; each with its
/// name.
#[must_use]
pub fn instruction_sets() -> Vec<(&'static str, Level)> {
    let widest = Level::new();
    #[cfg(target_arch = "x86_64")]
    {
        let avx2 = widest.as_avx2().map(|token| ("avx2", Level::Avx2(token)));
        if widest.as_avx512().is_some() {
            return std::iter::once(("avx512", widest)).chain(avx2).collect();
        }
        if let Some(avx2) = avx2 {
            return vec![avx2];
        }
    }
    vec![("baseline", widest)]
}
