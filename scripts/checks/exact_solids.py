"""Exact answers on solids by other programs: whether two meshes at a pose share points, the shared volume, and the
distance.

coal (PyPI) measures the distance of the surfaces. Manifold (PyPI manifold3d) measures the volume that the solids share,
so that a solid within another is a hit. trimesh makes the meshes. `prove` holds both to closed forms, without knotdock:
boxes and balls, apart, overlapping and nested.
"""

import math
from dataclasses import dataclass

import coal
import manifold3d
import numpy as np
import trimesh


@dataclass
class Exact:
    """The exact answer for two solids at a pose."""

    hit: bool
    # Of the solids' surfaces; zero where these meet.
    distance: float
    # Of what both solids share.
    volume: float


class Pair:
    """Two meshes; the second moves."""

    def __init__(self, name, first, second):
        self.name, self.meshes = name, [first, second]
        for mesh in self.meshes:
            if not mesh.is_watertight:
                raise ValueError(f"{name}: a mesh is not closed")
        self.trees = [tree(mesh) for mesh in self.meshes]
        self.solids = [solid(mesh) for mesh in self.meshes]
        self.size = max(np.ptp(mesh.vertices, axis=0).max() for mesh in self.meshes)

    def distance(self, turn, move):
        """Distance of the surfaces, zero where they meet."""
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        still = coal.Transform3s.Identity()
        coal.distance(self.trees[0], still, self.trees[1], coal.Transform3s(turn, move), request, result)
        return max(0.0, result.min_distance)

    def exact(self, turn, move):
        """The answer at a pose: y of the second goes to turn y + move."""
        volume = self.volume(turn, move)
        distance = self.distance(turn, move)
        # Surfaces that are apart leave all or nothing in common; rounding is far below any solid's volume.
        least = min(abs(solid.volume()) for solid in self.solids)
        return Exact(distance == 0 or volume > 1e-6 * least, distance, volume)

    def force(self, turn, move):
        """Minus the slope of the shared volume by the move, by central differences."""
        step = 1e-4 * self.size
        return np.array(
            [-(self.volume(turn, move + by) - self.volume(turn, move - by)) / (2 * step) for by in step * np.eye(3)]
        )

    def volume(self, turn, move):
        """The volume that both share."""
        return max(0.0, (self.solids[0] ^ self.solids[1].transform(np.column_stack([turn, move]))).volume())

    def poses(self, count, random):
        """Rotations and translations: every other one near contact, the rest anywhere between deep and far."""
        found = []
        for index in range(count):
            turn = rotation(random)
            away = random.normal(size=3)
            away /= np.linalg.norm(away)
            middle = self.meshes[0].bounds.mean(axis=0) - turn @ self.meshes[1].bounds.mean(axis=0)
            if index % 2 == 1:
                # From within, too: a solid may be in another's hole.
                contact = self.contact(turn, middle, away, index % 4 == 3)
                reach = contact + random.uniform(-0.03, 0.03) * self.size
            else:
                reach = random.uniform(0, 1.3) * self.size
            found.append((turn, middle + reach * away))
        return found

    def contact(self, turn, middle, away, within):
        """Where on a ray the surfaces first meet: from the middle outward, or, where they meet there, from afar."""
        reach, sign = (0, 1) if within else (2 * self.size, -1)
        for step in range(100):
            gap = self.distance(turn, middle + reach * away)
            if gap < 1e-5 * self.size:
                return self.contact(turn, middle, away, False) if within and step == 0 else reach
            reach += sign * gap
            if not 0 <= reach <= 2 * self.size:
                break
        return max(reach, 0)


def tree(mesh):
    """coal's tree of a mesh."""
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(mesh.faces), len(mesh.vertices))
    model.addVertices(np.asarray(mesh.vertices, dtype=float))
    model.addTriangles(np.asarray(mesh.faces, dtype=np.int64))
    model.endModel()
    return model


def solid(mesh):
    """Manifold's solid of a mesh."""
    made = manifold3d.Manifold(manifold3d.Mesh64(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.uint64)))
    if made.status() != manifold3d.Error.NoError:
        raise ValueError(f"Manifold refuses a mesh: {made.status()}")
    return made


def rotation(random):
    """A rotation matrix, all alike likely."""
    w, x, y, z = quaternion = random.normal(size=4)
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(turn):
    """The quaternion w, x, y, z of a rotation matrix."""
    w, x, y, z = trimesh.transformations.quaternion_from_matrix(turn)
    return [w, x, y, z]


def box(edges, at=(0, 0, 0)):
    return trimesh.creation.box(edges).apply_translation(at)


def hollow(edges, wall):
    """A box with a closed hole of its shape."""
    hole = box([edge - 2 * wall for edge in edges])
    hole.invert()
    return trimesh.util.concatenate([box(edges), hole])


def bracket(long, wide, thick):
    """An L of two plates, extruded."""
    outline = [[0, 0], [long, 0], [long, thick], [thick, thick], [thick, long], [0, long]]
    corners = [[x, y, z] for z in (0, wide) for x, y in outline]
    cap = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
    faces = [[a, c, b] for a, b, c in cap] + [[a + 6, b + 6, c + 6] for a, b, c in cap]
    for i in range(6):
        j = (i + 1) % 6
        faces += [[i, j, j + 6], [i, j + 6, i + 6]]
    return trimesh.Trimesh(corners, faces)


def pairs(bunny):
    """Four pairs; `bunny` is the path of a mesh with neither planes nor symmetries."""
    return [
        Pair("box and ball", box([2, 1.4, 1]), trimesh.creation.icosphere(3, 0.3)),
        Pair("bunny and bracket", trimesh.load(bunny, process=False), bracket(4, 2.5, 1.2)),
        Pair("torus and rod", trimesh.creation.torus(1, 0.35), trimesh.creation.cylinder(0.25, 1.6)),
        Pair("hollow box and cross", hollow([3, 2.6, 2.4], 0.4), cross(1.1, 0.35)),
    ]


def cross(long, thick):
    """Three rods through one point, joined."""
    rods = [solid(box(np.roll([long, thick, thick], axis))) for axis in range(3)]
    joined = (rods[0] + rods[1] + rods[2]).to_mesh64()
    return trimesh.Trimesh(joined.vert_properties[:, :3], joined.tri_verts.astype(np.int64))


def prove(random):
    """Holds both programs to closed forms; raises AssertionError."""
    edges = [np.array([2.0, 1.4, 1.0]), np.array([0.5, 0.9, 0.7])]
    boxes = Pair("boxes", box(edges[0]), box(edges[1]))
    for _ in range(300):
        move = random.uniform(-1.6, 1.6, size=3)
        low = np.maximum(-edges[0] / 2, move - edges[1] / 2)
        high = np.minimum(edges[0] / 2, move + edges[1] / 2)
        exact = boxes.exact(np.eye(3), move)
        gap = np.linalg.norm(np.maximum(0, low - high))
        volume = np.prod(np.maximum(0, high - low))
        nested = bool(np.all(np.abs(move) + edges[1] / 2 < edges[0] / 2))
        assert abs(exact.volume - volume) < 1e-9, (move, exact, volume)
        assert nested or abs(exact.distance - gap) < 1e-9, (move, exact, gap)
        assert exact.hit == (gap == 0), (move, exact)
        assert not nested or exact.distance > 0, "a surface within another is apart from it"
    radii = [0.8, 0.5]
    meshes = [trimesh.creation.icosphere(4, radius) for radius in radii]
    balls = Pair("balls", *meshes)
    # A mesh of corners on the sphere is within it; its faces are at most this far in.
    deep = sum(radius - np.linalg.norm(mesh.triangles_center, axis=1).min() for radius, mesh in zip(radii, meshes))
    for _ in range(200):
        turn, away = rotation(random), random.normal(size=3)
        apart = random.uniform(0.05, 1.6)
        exact = balls.exact(turn, away * apart / np.linalg.norm(away))
        gap = apart - sum(radii)
        if gap > 0:
            assert gap <= exact.distance <= gap + 2 * deep, (gap, exact, deep)
        if abs(gap) > 2 * deep:
            assert exact.hit == (gap < 0), (gap, exact)
        lens = lens_volume(*radii, apart)
        assert abs(exact.volume - lens) < 0.02 * lens + 1e-3, (apart, exact, lens)
    shell = Pair("shell and box", hollow([3, 3, 3], 0.5), box([1, 1, 1]))
    inside = shell.exact(np.eye(3), np.array([0.2, 0, 0]))
    assert not inside.hit and abs(inside.distance - 0.3) < 1e-9, inside
    wall = shell.exact(np.eye(3), np.array([0.6, 0, 0]))
    assert wall.hit and abs(wall.volume - 0.1) < 1e-9, wall


def lens_volume(first, second, apart):
    """Volume that two balls share."""
    if apart >= first + second:
        return 0.0
    if apart <= abs(first - second):
        return 4 / 3 * math.pi * min(first, second) ** 3
    over = (first + second - apart) ** 2
    return math.pi * over * (apart**2 + 2 * apart * (first + second) - 3 * (first - second) ** 2) / (12 * apart)
