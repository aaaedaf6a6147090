//! Running a loop with the widest vector instructions that the machine has.

/// Runs `task` compiled for the best instruction set found at run time (AVX2 with FMA on x86-64).
///
/// The closure must be `#[inline(always)]`, and so must whatever it calls that is to profit: only what is inlined is
/// compiled for the wider registers. It is called through `FnMut` on purpose. Through `FnOnce`, as in `pulp`
/// itself, the compiler adds a shim to a closure that only borrows. The shim is not inlined, and all loops in it ran on
/// SSE2.
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

/// [`vectorized`] of an expression.
macro_rules! vectorize {
    ($task:expr) => {
        $crate::vectorized::vectorized(
            #[inline(always)]
            || $task,
        )
    };
}

/// Runs an expression that names the vectors: `simd` is the token of the best instruction set found at run time.
///
/// `with_simd!(<'a>(values: &'a [f64], scale: f64) -> f64, |simd| sum(simd, values, scale))`. One type parameter with
/// a bound may follow the lifetime. Whatever the expression calls must be `#[inline(always)]`.
macro_rules! with_simd {
    (<$life:lifetime $(, $generic:ident: $bound:path)?>($($name:ident: $type:ty),*) -> $output:ty, |$simd:ident| $body:expr) => {{
        struct Task<$life $(, $generic)?> {
            $($name: $type),*
        }
        impl<$life $(, $generic: $bound)?> pulp::WithSimd for Task<$life $(, $generic)?> {
            type Output = $output;

            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, $simd: S) -> $output {
                let Self { $($name),* } = self;
                $body
            }
        }
        pulp::Arch::new().dispatch(Task { $($name),* })
    }};
}

pub(crate) use {vectorize, with_simd};
