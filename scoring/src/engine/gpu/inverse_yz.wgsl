// Inverse along y and then along z (complex to real, two rows at a time), of one image and x; and the best of each row.

@group(0) @binding(0) var<storage, read> twiddle_y: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read> twiddle_z: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read> columns: array<Column>;
// First column of each plane, and their number.
@group(0) @binding(3) var<storage, read> planes: array<u32>;
// [image][x][column]
@group(0) @binding(4) var<storage, read> along: array<vec2<f32>>;
// [image][x][y][z]
@group(0) @binding(5) var<storage, read_write> grid: array<f32>;
// [image][x][y]
@group(0) @binding(6) var<storage, read_write> row_best: array<f32>;

const HALF = NY / 2u;
const ROWS = 2u * LINES_Z;
// Invocations of a row when its best is sought.
const SHARE = WIDTH / ROWS;

var<workgroup> bests: array<f32, WIDTH>;

// Place in `tile`: [kz][y % 2][y / 2], so that both rows of a pair are read without conflicts.
fn tiled(kz: u32, y: u32) -> u32 {
    return (kz * 2u + y % 2u) * HALF + y / 2u;
}

@compute @workgroup_size(WIDTH)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let plane = group.y * NX + group.x;
    let tile_start = plane * TILE;
    for (var first = 0u; first < DEPTH; first += LINES_Y) {
        for (var item = lane; item < LINES_Y * NY; item += WIDTH) {
            ping[at_y(item / NY, item % NY)] = vec2<f32>(0.0);
        }
        workgroupBarrier();
        let end = planes[min(first + LINES_Y, DEPTH)];
        for (var column = planes[first] + lane; column < end; column += WIDTH) {
            ping[at_y(columns[column].plane - first, columns[column].y)] =
                along[plane * COLUMNS + column];
        }
        workgroupBarrier();
        transform_y(lane);
        for (var item = lane; item < LINES_Y * NY; item += WIDTH) {
            let kz = first + item / NY;
            let y = item % NY;
            if (kz < DEPTH) {
                tile[tile_start + tiled(kz, y)] = result_y(item / NY, y);
            }
        }
        tileBarrier();
    }
    for (var first = 0u; first < HALF; first += LINES_Z) {
        for (var item = lane; item < NZ * LINES_Z; item += WIDTH) {
            let kz = item / LINES_Z;
            let line = item % LINES_Z;
            // The other half of the modes follows from this one; what is not kept is zero.
            if (kz >= DEPTH && kz <= NZ - DEPTH) {
                ping[at_z(line, kz)] = vec2<f32>(0.0);
            } else if (kz < DEPTH && first + line < HALF) {
                let a = tile[tile_start + tiled(kz, 2u * (first + line))];
                let b = tile[tile_start + tiled(kz, 2u * (first + line) + 1u)];
                // A + iB at kz, and A* + iB* at -kz; the mean of a real row is real.
                if (kz == 0u) {
                    ping[at_z(line, 0u)] = vec2<f32>(a.x, b.x);
                } else {
                    ping[at_z(line, kz)] = vec2<f32>(a.x - b.y, a.y + b.x);
                    ping[at_z(line, NZ - kz)] = vec2<f32>(a.x + b.y, b.x - a.y);
                }
            }
        }
        workgroupBarrier();
        transform_z(lane);
        for (var item = lane; item < LINES_Z * NZ; item += WIDTH) {
            let pair = first + item / NZ;
            if (pair < HALF) {
                let value = result_z(item / NZ, item % NZ);
                let at = (plane * NY + 2u * pair) * NZ + item % NZ;
                grid[at] = value.x;
                grid[at + NZ] = value.y;
            }
        }
        let row = lane % ROWS;
        var best = LOWEST;
        for (var z = lane / ROWS; z < NZ; z += SHARE) {
            let value = result_z(row / 2u, z);
            best = max(best, select(value.x, value.y, row % 2u == 1u));
        }
        bests[lane] = best;
        workgroupBarrier();
        if (lane < ROWS && 2u * first + lane < NY) {
            for (var share = 1u; share < SHARE; share += 1u) {
                best = max(best, bests[share * ROWS + lane]);
            }
            row_best[plane * NY + 2u * first + lane] = best;
        }
        workgroupBarrier();
    }
}
