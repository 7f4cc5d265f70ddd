#pragma once

#include <optional>
#include <string>

#include "datasets/cameras/image_size.hpp"
#include "datasets/cameras/lower_case.hpp"
#include "datasets/sources/recording.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {

// What the readers of cameras' files share. @throws std::invalid_argument by YamlFields::fail

/// What the setup says beside the file, and what is to be told of it.
struct BesideFile {
  bool is_rectified = false;
  std::optional<ImageSize> size;
  std::optional<LensModel> lens;
  std::string note;
};

/// OpenCV's coefficients, as many as the lens has; OpenCV writes 5, 8, 12 or 14 for one that has fewer.
void take_distortion(const YamlFields& fields, const std::string& key, LensModel lens,
                     CameraIntrinsics& camera);

/// Coefficients by their names, k1, k2, p1, …, that stand behind `prefix`: of the lens that is named, else
/// OpenCV's, a plumb bob or, where k4, k5 and k6 stand, rational. Those of other lenses have to be 0.
void take_named_coefficients(const YamlFields& fields, const std::string& prefix,
                             std::optional<LensModel> lens, CameraIntrinsics& camera);

/// The lens that a key names in one of ROS's names; without the key the other one, and "none" is a plumb bob.
LensModel read_lens(const YamlFields& fields, const std::string& key, const std::string& otherwise);

/// The lens that a file names: by ROS's key in one of ROS's names, by others' as far as it is one of a lens.
std::optional<LensModel> named_lens(const YamlFields& file);

/// The camera of a file that knows no rectified one beside it.
CameraIntrinsics only_camera(const YamlFields& fields, CameraIntrinsics camera, bool is_rectified);

/// Refuses a name for a file of one camera that is not called so.
void require_name(const YamlFields& file, const std::string& wanted);

/// That of the file, else `given`.
ImageSize read_size(const YamlFields& file, std::optional<ImageSize> given);

}  // namespace clearway
