//! The choice of vector instructions at run time: [`on_widest`], [`on_lanes`].

use fearless_simd::Level;
#[cfg(target_arch = "x86_64")]
use fearless_simd::Simd;

/// Runs `work` with the widest vector instructions that `level` has: it is compiled for AVX-512,
/// for AVX2 and for the baseline.
///
/// Everything that `work` calls must be inlined into it, because a function of its own is compiled
/// for the baseline only. No result depends on the choice: the compiler reorders nothing, and
/// [`Lanes`](crate::Lanes) fuse the same operations everywhere (in software, and slowly, on
/// processors from before 2013).
#[inline(always)]
pub fn on_widest<R>(level: Level, work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(avx512) = level.as_avx512() {
            return avx512.vectorize(work);
        }
        if let Some(avx2) = level.as_avx2() {
            return avx2.vectorize(work);
        }
    }
    let _ = level;
    work()
}

/// [`on_widest`], but `None`, and not compiled, where eight lanes are slower than one after the
/// other: on x86-64 without AVX2, where every fused operation is a call.
#[inline(always)]
pub fn on_vectors<R>(level: Level, work: impl FnOnce() -> R) -> Option<R> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = level.as_avx512() {
        Some(avx512.vectorize(work))
    } else {
        level.as_avx2().map(|avx2| avx2.vectorize(work))
    }
    #[cfg(not(target_arch = "x86_64"))]
    Some(on_widest(level, work))
}

/// [`on_widest`] for a single particle: of wide instructions it needs the fused operation, a call
/// without them, and no vectors. So it is compiled for AVX2 and for the baseline only.
#[inline(always)]
pub fn on_fused<R>(level: Level, work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = level.as_avx2() {
        return avx2.vectorize(work);
    }
    let _ = level;
    work()
}

/// Part of the work on chunks of `W` particles: [`on_fused`] for one, [`on_vectors`] for eight,
/// [`on_widest`] for other numbers. `None` where eight lanes are not compiled.
#[inline(always)]
pub fn on_lanes<const W: usize, R>(level: Level, work: impl FnOnce() -> R) -> Option<R> {
    match W {
        1 => Some(on_fused(level, work)),
        8 => on_vectors(level, work),
        _ => Some(on_widest(level, work)),
    }
}
