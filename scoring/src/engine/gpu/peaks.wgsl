// The best voxels of each image, kept apart from one another; one workgroup an image. Ties go to the lower voxel.
//
// Around a peak the grid and its rows' bests are overwritten, so that each further peak costs a pass over the rows alone.

// [image][x][y][z]
@group(0) @binding(0) var<storage, read_write> grid: array<f32>;
// [image][x][y]
@group(0) @binding(1) var<storage, read_write> row_best: array<f32>;
// [image][peak]: voxel + 1, or 0 where nothing is left; bits of the score.
@group(0) @binding(2) var<storage, read_write> peaks: array<vec2<u32>>;

const NONE = 0xffffffffu;
const ACROSS = 2u * REACH_Y + 1u;
const DEEP = 2u * REACH_Z + 1u;

var<workgroup> values: array<f32, WIDTH>;
var<workgroup> places: array<u32, WIDTH>;

// The largest of the lanes' values with its place, the lowest of equals.
fn reduce(lane: u32, value: f32, place: u32) -> vec2<u32> {
    values[lane] = value;
    places[lane] = place;
    workgroupBarrier();
    for (var half = WIDTH / 2u; half > 0u; half /= 2u) {
        if (lane < half) {
            let other = values[lane + half];
            let there = places[lane + half];
            if (other > values[lane] || (other == values[lane] && there < places[lane])) {
                values[lane] = other;
                places[lane] = there;
            }
        }
        workgroupBarrier();
    }
    let best = vec2<u32>(places[0], bitcast<u32>(values[0]));
    workgroupBarrier();
    return best;
}

@compute @workgroup_size(WIDTH)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let image = group.x;
    let first = image * NX * NY;
    for (var peak = 0u; peak < PEAKS; peak += 1u) {
        var best = LOWEST;
        var place = NONE;
        for (var row = lane; row < NX * NY; row += WIDTH) {
            let value = row_best[first + row];
            if (value > best) {
                best = value;
                place = row;
            }
        }
        let row = reduce(lane, best, place).x;
        best = LOWEST;
        place = NONE;
        if (row != NONE) {
            for (var z = lane; z < NZ; z += WIDTH) {
                let value = grid[(first + row) * NZ + z];
                if (value > best) {
                    best = value;
                    place = z;
                }
            }
        }
        let top = reduce(lane, best, place);
        let some = row != NONE && top.x != NONE;
        if (lane == 0u) {
            let voxel = select(0u, row * NZ + top.x + 1u, some);
            peaks[image * PEAKS + peak] = vec2<u32>(voxel, top.y);
        }
        if (some) {
            // One invocation a neighbouring row.
            for (var near = lane; near < (2u * REACH_X + 1u) * ACROSS; near += WIDTH) {
                let x = (row / NY + NX + near / ACROSS - REACH_X) % NX;
                let y = (row % NY + NY + near % ACROSS - REACH_Y) % NY;
                let start = (first + x * NY + y) * NZ;
                for (var step = 0u; step < DEEP; step += 1u) {
                    grid[start + (top.x + NZ + step - REACH_Z) % NZ] = LOWEST;
                }
                var rest = LOWEST;
                for (var z = 0u; z < NZ; z += 1u) {
                    rest = max(rest, grid[start + z]);
                }
                row_best[first + x * NY + y] = rest;
            }
        }
        storageBarrier();
        workgroupBarrier();
    }
}
