// Inverse along y, a plane kz at a time.

@group(0) @binding(0) var<storage, read> twiddle: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read> columns: array<Column>;
@group(0) @binding(2) var<storage, read> planes: array<u32>;
// [image][column][x]
@group(0) @binding(3) var<storage, read> along: array<vec2<f32>>;
// [image][x][kz][y]
@group(0) @binding(4) var<storage, read_write> rows: array<vec2<f32>>;

@compute @workgroup_size(WIDTH)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = group.x * LINES;
    let kz = group.y;
    for (var item = lane; item < LINES * NY; item += WIDTH) {
        ping[item] = vec2<f32>(0.0);
    }
    workgroupBarrier();
    let start = planes[kz];
    let count = planes[kz + 1u] - start;
    for (var item = lane; item < count * LINES; item += WIDTH) {
        let column = start + item / LINES;
        let line = item % LINES;
        if (first + line < NX) {
            ping[line * NY + columns[column].y] =
                along[(group.z * COLUMNS + column) * NX + first + line];
        }
    }
    workgroupBarrier();
    transform(lane);
    for (var item = lane; item < LINES * NY; item += WIDTH) {
        let x = first + item / NY;
        if (x < NX) {
            rows[((group.z * NX + x) * DEPTH + kz) * NY + item % NY] = result(item);
        }
    }
}
