"""Paints free space, adds what a camera saw, and asks the map. Cells begin with "# %%": run it whole, or step by step."""

# %% A map of 2 cm voxels, and a stroke of spheres along the y axis, painted for the part "tool".
import tempfile

import numpy as np

import clearway as cw

fused = cw.FreeSpaceMap(resolution=0.02)
volume = fused.add_volume("along the shelf", ["tool"])
y = np.arange(-0.4, 0.41, 0.05)
centers = np.column_stack([np.zeros_like(y), y, np.full_like(y, 0.15)])
counts = fused.paint(volume, centers, radius=0.12)
print(f"{counts.newly} voxels painted")

# %% A camera at (1, 0, 0.15) m looks against the x axis at a post of 4 cm: a cloud in its own frame, and its pose.
up, aside = np.meshgrid(np.arange(-0.15, 0.151, 0.01), np.arange(-0.02, 0.021, 0.01))
cloud = np.stack([np.full(up.size, -0.99), aside.ravel(), up.ravel()], axis=1)
map_from_camera = np.eye(4)
map_from_camera[:3, 3] = [1.0, 0.0, 0.15]
seen = fused.insert(cloud, map_from_camera, time=0.0)
print(f"{seen.inserted} of {len(cloud)} points inserted")

# %% A snapshot answers. What is painted and occupied is a conflict: blocked under every policy.
snapshot = fused.snapshot()
print(snapshot)
print("surface of the post:", snapshot.state([0.01, 0.0, 0.15]).name)
states, extent = snapshot.slice("z", 0.15)
print(f"slice of {states.shape} voxels over x, y in {np.round(extent, 2)} m")
in_conflict = int((states == cw.VoxelState.conflict).sum())
print(f"{in_conflict} voxels of it in conflict")
# With matplotlib: plt.imshow(states, origin="lower", extent=extent)

# %% How far is what blocks the tool? Whole arrays at once.
blocked = snapshot.blocked_space("painted", max_distance=0.3)
distances = blocked.clearances(centers)
print("clearance along the stroke, mm:", np.round(1000 * distances).astype(int))
behind = snapshot.line_of_sight([0.5, 0.0, 0.15], [-0.5, 0.0, 0.15])
print("the line through the post is free:", behind)

# %% Saved, loaded, and the same.
with tempfile.TemporaryDirectory() as folder:
    snapshot.save(folder)
    loaded = cw.load_map(folder)
    assert (loaded.slice("z", 0.15)[0] == states).all()

assert snapshot.state([0.01, 0.0, 0.15]) == cw.VoxelState.conflict
assert in_conflict > 0 and not behind
assert distances[0] > 0.06 > distances[len(distances) // 2]
print("as expected")
