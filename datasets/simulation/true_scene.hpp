#pragma once

#include "datasets/descriptions/scene.hpp"

namespace clearway {

/// The scene as it truly is, where its camera's errors make the setup wrong: camera and boards are other than
/// stated, and the fingers that its seed draws lie on tags.
Scene true_scene(const Scene& scene);

/// map_from_camera at a time after the first picture: on its path, straight from pose to pose, swaying.
Eigen::Isometry3d camera_at(const Scene& scene, double time);

}  // namespace clearway
