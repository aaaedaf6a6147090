// Forward along x, column by column: the turned ligand's transform, laid out as the receptor's spectra.

@group(0) @binding(0) var<storage, read> twiddle: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read> columns: array<Column>;
// [turn, field][column][x]
@group(0) @binding(2) var<storage, read> partial: array<vec2<f32>>;
// [turn][column][field][kx]
@group(0) @binding(3) var<storage, read_write> turned: array<vec2<f32>>;

@compute @workgroup_size(WIDTH)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = group.x * LINES;
    let turn = group.y / FIELDS;
    let field = group.y % FIELDS;
    for (var item = lane; item < LINES * MX; item += WIDTH) {
        let column = first + item / MX;
        let x = item % MX;
        var value = vec2<f32>(0.0);
        if (column < COLUMNS && x < BX) {
            value = partial[(group.y * COLUMNS + column) * BX + x];
        }
        ping[at(item / MX, x)] = value;
    }
    workgroupBarrier();
    transform(lane);
    for (var item = lane; item < LINES * LONGEST; item += WIDTH) {
        let line = item / LONGEST;
        let mode = item % LONGEST;
        if (first + line >= COLUMNS) {
            continue;
        }
        let column = columns[first + line];
        let length = 2u * column.side + 1u;
        if (mode < length) {
            // kx = mode - side, in transform order.
            let place = (mode + MX - column.side) % MX;
            turned[FIELDS * (turn * MODES + column.start) + field * length + mode] =
                result(line, place);
        }
    }
}
