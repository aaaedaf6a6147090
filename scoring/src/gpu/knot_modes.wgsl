// Spreads knots onto the fine grid. One invocation has one point on the first three axes of one knot's window.
//
// Sums are of whole numbers, so that they come out the same in whatever order they are taken.

// Per knot the window's first point on each of four axes.
@group(0) @binding(0) var<storage, read> firsts: array<vec4<u32>>;
// Per knot and axis the variable of the window's polynomials.
@group(0) @binding(1) var<storage, read> variables: array<vec4<f32>>;
// In units of the whole numbers.
@group(0) @binding(2) var<storage, read> weights: array<vec2<f32>>;
// [power, highest first][point]
@group(0) @binding(3) var<storage, read> window: array<f32>;
// Real and imaginary parts in turn.
@group(0) @binding(4) var<storage, read_write> fine: array<atomic<i32>>;

// Window value at a point. An axis of one point has no window.
fn window_at(axis: u32, point: u32, variable: f32) -> f32 {
    if (WIDTHS[axis] == 1u) {
        return 1.0;
    }
    var value = window[point];
    for (var power = 1u; power < TERMS; power += 1u) {
        value = value * variable + window[power * WINDOW + point];
    }
    return value;
}

@compute @workgroup_size(WIDTH)
fn spread(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = (group.y * MAX_GROUPS + group.x) * WIDTH + lane;
    let outer = WIDTHS.x * WIDTHS.y * WIDTHS.z;
    let knot = item / outer;
    if (knot >= KNOTS) {
        return;
    }
    let place = item % outer;
    let i = vec3<u32>(place / (WIDTHS.y * WIDTHS.z), place / WIDTHS.z % WIDTHS.y, place % WIDTHS.z);
    let x = variables[knot];
    let value = window_at(0u, i.x, x.x) * window_at(1u, i.y, x.y) * window_at(2u, i.z, x.z);
    let first = firsts[knot];
    let at = (first.xyz + i) % SIZES.xyz;
    let row = ((at.x * SIZES.y + at.y) * SIZES.z + at.z) * SIZES.w;
    for (var iw = 0u; iw < WIDTHS.w; iw += 1u) {
        let whole = vec2<i32>(round(value * window_at(3u, iw, x.w) * weights[knot]));
        let cell = 2u * (row + (first.w + iw) % SIZES.w);
        atomicAdd(&fine[cell], whole.x);
        atomicAdd(&fine[cell + 1u], whole.y);
    }
}
