// Forward along y, a plane kz at a time: the columns that are kept go on.

@group(0) @binding(0) var<storage, read> twiddle: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read> columns: array<Column>;
// First column of each plane, and their number.
@group(0) @binding(2) var<storage, read> planes: array<u32>;
// [turn, field][x][kz][y]
@group(0) @binding(3) var<storage, read> rows: array<vec2<f32>>;
// [turn, field][column][x]
@group(0) @binding(4) var<storage, read_write> partial: array<vec2<f32>>;

@compute @workgroup_size(WIDTH)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = group.x * LINES;
    let kz = group.y;
    for (var item = lane; item < LINES * MY; item += WIDTH) {
        let x = first + item / MY;
        let y = item % MY;
        var value = vec2<f32>(0.0);
        if (x < BX && y < BY) {
            value = rows[((group.z * BX + x) * DEPTH + kz) * BY + y];
        }
        ping[at(item / MY, y)] = value;
    }
    workgroupBarrier();
    transform(lane);
    let start = planes[kz];
    let count = planes[kz + 1u] - start;
    for (var item = lane; item < count * LINES; item += WIDTH) {
        let column = start + item / LINES;
        let line = item % LINES;
        if (first + line < BX) {
            partial[(group.z * COLUMNS + column) * BX + first + line] =
                result(line, columns[column].fine_y);
        }
    }
}
