// Spreads the turned ligand's knots onto the block, every field. One invocation has one (x, y) of one knot's window.
//
// Sums are of whole numbers, so that they come out the same in whatever order they are taken; weights carry the scale.

@group(0) @binding(0) var<storage, read> knots: array<vec4<f32>>;
// [knot][field], in units of the whole numbers.
@group(0) @binding(1) var<storage, read> weights: array<f32>;
// [power][point]
@group(0) @binding(2) var<storage, read> window: array<f32>;
// Per turn three rows (matrix row, offset): Å to cells.
@group(0) @binding(3) var<storage, read> turns: array<vec4<f32>>;
// [turn][field][x][y][z]
@group(0) @binding(4) var<storage, read_write> block: array<atomic<i32>>;

const HALF_WINDOW = 0.5 * f32(WINDOW);

// Window value at a point for the window's variable.
fn window_at(point: u32, variable: f32) -> f32 {
    var value = window[(TERMS - 1u) * WINDOW + point];
    for (var power = TERMS - 1u; power > 0u; power -= 1u) {
        value = value * variable + window[(power - 1u) * WINDOW + point];
    }
    return value;
}

@compute @workgroup_size(WIDTH)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = (group.y * MAX_GROUPS + group.x) * WIDTH + lane;
    let knot = item / (WINDOW * WINDOW);
    let turn = group.z;
    if (knot >= KNOTS) {
        return;
    }
    let place = item % (WINDOW * WINDOW);
    let point = vec4<f32>(knots[knot].xyz, 1.0);
    let low = vec3<f32>(
        dot(turns[3u * turn], point),
        dot(turns[3u * turn + 1u], point),
        dot(turns[3u * turn + 2u], point),
    ) - HALF_WINDOW;
    let first = ceil(low);
    let variable = 2.0 * (first - low) - 1.0;
    let at = vec3<u32>(clamp(
        vec3<i32>(first),
        vec3<i32>(0),
        vec3<i32>(i32(BX - WINDOW), i32(BY - WINDOW), i32(BZ - WINDOW)),
    ));
    let ix = place / WINDOW;
    let iy = place % WINDOW;
    let value = window_at(ix, variable.x) * window_at(iy, variable.y);
    for (var iz = 0u; iz < WINDOW; iz += 1u) {
        let product = value * window_at(iz, variable.z);
        for (var field = 0u; field < FIELDS; field += 1u) {
            let row = ((turn * FIELDS + field) * BX + at.x + ix) * BY + at.y + iy;
            let whole = i32(round(product * weights[knot * FIELDS + field]));
            atomicAdd(&block[row * BZ + at.z + iz], whole);
        }
    }
}
