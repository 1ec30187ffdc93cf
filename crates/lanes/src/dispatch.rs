//! The choice of vector instructions at run time: [`on_widest`].

use fearless_simd::Level;
#[cfg(target_arch = "x86_64")]
use fearless_simd::Simd;

/// Runs `work`, compiled for AVX-512, for AVX2 and for the baseline, on the widest of the three
/// that `level` has.
///
/// What `work` calls must be inlined into it to be compiled so. No result depends on the choice:
/// nothing is reordered, and what is fused is so everywhere, see [`Lanes`](crate::Lanes), if slowly
/// on processors of before 2013.
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
