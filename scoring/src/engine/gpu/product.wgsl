// sum_q U_q conj(B_q), the ligand's transform read as a turn of the grid leaves it, and the inverse along x.

@group(0) @binding(0) var<storage, read> twiddle: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read> columns: array<Column>;
// [column][field][kx]
@group(0) @binding(2) var<storage, read> spectra: array<vec2<f32>>;
// [turn][column][field][kx]
@group(0) @binding(3) var<storage, read> turned: array<vec2<f32>>;
// Per image the turn of the batch, and which turn of the grid it is.
@group(0) @binding(4) var<storage, read> images: array<vec2<u32>>;
// [image][x][column]
@group(0) @binding(5) var<storage, read_write> along: array<vec2<f32>>;
// [turn of the grid][column]: the first mode of the column that is read, and how: 1 reversed, 2 conjugated.
@group(0) @binding(6) var<storage, read> readings: array<vec2<u32>>;

@compute @workgroup_size(WIDTH)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = group.x * LINES;
    let image = images[group.y];
    for (var item = lane; item < LINES * NX; item += WIDTH) {
        ping[at(item / NX, item % NX)] = vec2<f32>(0.0);
    }
    workgroupBarrier();
    for (var item = lane; item < LINES * LONGEST; item += WIDTH) {
        let line = item / LONGEST;
        let mode = item % LONGEST;
        if (first + line >= COLUMNS) {
            continue;
        }
        let column = columns[first + line];
        let length = 2u * column.side + 1u;
        if (mode >= length) {
            continue;
        }
        let ours = FIELDS * column.start + mode;
        let reading = readings[image.y * COLUMNS + first + line];
        let reversed = (reading.y & 1u) != 0u;
        let sign = select(-1.0, 1.0, (reading.y & 2u) != 0u);
        let theirs = FIELDS * (image.x * MODES + reading.x)
            + select(mode, length - 1u - mode, reversed);
        var sum = vec2<f32>(0.0);
        for (var field = 0u; field < FIELDS; field += 1u) {
            let a = spectra[ours + field * length];
            let b = turned[theirs + field * length];
            sum += multiply(a, vec2<f32>(b.x, sign * b.y));
        }
        ping[at(line, (mode + NX - column.side) % NX)] = sum;
    }
    workgroupBarrier();
    transform(lane);
    for (var item = lane; item < LINES * NX; item += WIDTH) {
        let x = item / LINES;
        let line = item % LINES;
        if (first + line < COLUMNS) {
            along[(group.y * NX + x) * COLUMNS + first + line] = result(line, x);
        }
    }
}
