#include "datasets/camera_files/camera_fields.hpp"

#include <stdexcept>
#include <utility>
#include <vector>

#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::pair<const char*, const char*> size_keys[] = {
    {"image_width", "image_height"},
    {"image_Width", "image_Height"},
    {"imageWidth", "imageHeight"},
    {"calibration_image_width", "calibration_image_height"},
    {"width", "height"},
    {"w", "h"}};

}  // namespace

void take_distortion(const YamlFields& fields, const std::string& key, LensModel lens,
                     CameraIntrinsics& camera) {
  const std::vector<double> values = fields.flat_numbers(key, within_reach);
  const std::size_t size = values.size();
  const bool is_list = size == 4 || size == 5 || size == 8 || size == 12 || size == 14;
  if (!is_list && !(values.empty() && lens != LensModel::fisheye))
    fields.fail(key, std::string("expected ") + (lens == LensModel::fisheye ? "4" : "4, 5 or 8") +
                         " numbers, got " + std::to_string(size));
  try {
    set_lens(camera, lens, values);
  } catch (const std::runtime_error& error) {
    fields.fail(key, error.what());
  }
}

LensModel read_lens(const YamlFields& fields, const std::string& key, const std::string& otherwise) {
  const std::string name = lower_case(fields.text(key, otherwise));
  if (name == "none") return LensModel::plumb_bob;
  const auto lens = lens_named(name);
  if (!lens) fields.fail(key, "the lens '" + name + "' is not known, expected " + known_lenses);
  return *lens;
}

std::optional<LensModel> named_lens(const YamlFields& file) {
  if (file.has("distortion_model")) return read_lens(file, "distortion_model", "plumb_bob");
  for (const char* key : {"model", "camera_model", "lens", "lens_model", "camera_type"}) {
    if (!file.is_word(key)) continue;
    const std::string name = lower_case(file.text(key));
    const auto says = [&](const char* word) { return name.find(word) != std::string::npos; };
    if (says("fisheye") || says("equi") || says("kannala")) return LensModel::fisheye;
    if (const auto lens = lens_named(name)) return lens;
    const bool is_other = says("omni") || says("fov") || says("sphere") || says("mei") || says("eucm") ||
                          says("unified") || says("scaramuzza") || says("division") || name == "ds" ||
                          name == "ucm" || name == "atan";
    if (is_other) file.fail(key, "the lens " + quote(name) + " is not known, expected " + known_lenses);
  }
  return std::nullopt;
}

CameraIntrinsics only_camera(const YamlFields& fields, CameraIntrinsics camera, bool is_rectified) {
  if (is_rectified && has_distortion(camera))
    fields.fail("",
                "it says nothing of rectified pictures: expected ROS's camera_info with a projection_matrix");
  camera.is_rectified = is_rectified;
  return camera;
}

void require_name(const YamlFields& file, const std::string& wanted) {
  if (wanted.empty() || (file.has("camera_name") && file.text("camera_name") == wanted)) return;
  file.fail("", "it has one camera, which is not called " + quote(wanted) +
                    ": expected no `name` beside `file`, or another file");
}

ImageSize read_size(const YamlFields& file, std::optional<ImageSize> given) {
  constexpr Bounds sides{32, 20000};
  for (const auto& [width, height] : size_keys)
    if (file.has(width) || file.has(height)) return {file.integer(width, sides), file.integer(height, sides)};
  if (file.is_map("resolution")) {  // PhotonVision
    const YamlFields size = file.map("resolution");
    return {size.integer("width", sides), size.integer("height", sides)};
  }
  for (const char* name : {"image_size", "imageSize", "img_size"}) {
    if (!file.has(name)) continue;
    const std::vector<double> size =
        file.is_map(name) ? file.map(name).numbers("data", sides, 2) : file.numbers(name, sides, 2);
    return {static_cast<int>(size[0]), static_cast<int>(size[1])};
  }
  if (!given)
    file.fail("image_width",
              "it does not say how large the pictures are: expected image_width and image_height, or `width` "
              "and `height` beside `file`");
  return *given;
}

}  // namespace clearway
