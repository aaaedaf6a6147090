//! Running a loop with the widest vector instructions that the machine has.

/// Runs `task` compiled for the best instruction set found at run time (AVX2 with FMA on x86-64).
///
/// The closure must be `#[inline(always)]`, and so must whatever it calls that is to profit: only what is inlined is
/// compiled for the wider registers. It is called through `FnMut` on purpose. Called through `FnOnce`, as `pulp` does
/// by itself, a closure that only borrows goes through a shim of the compiler's, which is not inlined: all loops in it
/// then ran on SSE2.
#[inline(always)]
pub fn vectorized<R>(task: impl FnMut() -> R) -> R {
    pulp::Arch::new().dispatch(Task(task))
}

struct Task<F>(F);

impl<R, F: FnMut() -> R> pulp::WithSimd for Task<F> {
    type Output = R;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(mut self, _: S) -> R {
        (self.0)()
    }
}
