// Forward along z: two real rows as one complex line, of which the modes kz that are kept go on.

@group(0) @binding(0) var<storage, read> twiddle: array<vec2<f32>>;
// [turn, field][x][y][z]
@group(0) @binding(1) var<storage, read> block: array<i32>;
// [turn, field][x][kz][y]
@group(0) @binding(2) var<storage, read_write> rows: array<vec2<f32>>;

@compute @workgroup_size(WIDTH)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = group.x * LINES;
    let plane = group.z * BX + group.y;
    for (var item = lane; item < LINES * MZ; item += WIDTH) {
        let pair = first + item / MZ;
        let z = item % MZ;
        var value = vec2<f32>(0.0);
        if (2u * pair < BY && z < BZ) {
            let at = (plane * BY + 2u * pair) * BZ + z;
            value = vec2<f32>(f32(block[at]), f32(block[at + BZ]));
        }
        ping[at(item / MZ, z)] = value;
    }
    workgroupBarrier();
    transform(lane);
    for (var item = lane; item < DEPTH * LINES; item += WIDTH) {
        let kz = item / LINES;
        let line = item % LINES;
        let pair = first + line;
        if (2u * pair < BY) {
            // X = A + iB with A, B Hermitian.
            let value = result(line, kz);
            let mirror = result(line, (MZ - kz) % MZ);
            let at = (plane * DEPTH + kz) * BY + 2u * pair;
            rows[at] = 0.5 * vec2<f32>(value.x + mirror.x, value.y - mirror.y);
            rows[at + 1u] = 0.5 * vec2<f32>(value.y + mirror.y, mirror.x - value.x);
        }
    }
}
