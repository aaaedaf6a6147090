// Inverse along z, complex to real, two rows at a time; and the best of each row.

@group(0) @binding(0) var<storage, read> twiddle: array<vec2<f32>>;
// [image][x][kz][y]
@group(0) @binding(1) var<storage, read> rows: array<vec2<f32>>;
// [image][x][y][z]
@group(0) @binding(2) var<storage, read_write> grid: array<f32>;
// [image][x][y]
@group(0) @binding(3) var<storage, read_write> row_best: array<f32>;

@compute @workgroup_size(WIDTH)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = group.x * LINES;
    let plane = group.z * NX + group.y;
    for (var item = lane; item < LINES * NZ; item += WIDTH) {
        ping[item] = vec2<f32>(0.0);
    }
    workgroupBarrier();
    for (var item = lane; item < DEPTH * LINES; item += WIDTH) {
        let kz = item / LINES;
        let line = item % LINES;
        let pair = first + line;
        if (2u * pair < NY) {
            let at = (plane * DEPTH + kz) * NY + 2u * pair;
            let a = rows[at];
            let b = rows[at + 1u];
            // A + iB at kz, and A* + iB* at -kz; the mean of a real row is real.
            if (kz == 0u) {
                ping[line * NZ] = vec2<f32>(a.x, b.x);
            } else {
                ping[line * NZ + kz] = vec2<f32>(a.x - b.y, a.y + b.x);
                ping[line * NZ + NZ - kz] = vec2<f32>(a.x + b.y, b.x - a.y);
            }
        }
    }
    workgroupBarrier();
    transform(lane);
    for (var item = lane; item < LINES * NZ; item += WIDTH) {
        let pair = first + item / NZ;
        if (2u * pair < NY) {
            let value = result(item);
            let at = (plane * NY + 2u * pair) * NZ + item % NZ;
            grid[at] = value.x;
            grid[at + NZ] = value.y;
        }
    }
    for (var row = lane; row < 2u * LINES; row += WIDTH) {
        if (2u * first + row < NY) {
            var best = LOWEST;
            for (var z = 0u; z < NZ; z += 1u) {
                let value = result((row / 2u) * NZ + z);
                best = max(best, select(value.x, value.y, row % 2u == 1u));
            }
            row_best[plane * NY + 2u * first + row] = best;
        }
    }
}
