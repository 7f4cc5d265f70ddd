#include "datasets/cameras/nerf_camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "datasets/sources/lens.hpp"

namespace clearway {
namespace {

/// nerfstudio's camera of a frame: what it says itself comes before what the file says.
class NerfCamera {
 public:
  NerfCamera(const PathFields& file, const PathFields& frame) : file_(file), frame_(frame) {}

  std::optional<CameraIntrinsics> read(const std::optional<PictureSizes>& sizes) const {
    if (!has("fl_x") && !has("camera_angle_x")) return std::nullopt;
    std::optional<ImageSize> size;
    if (!has("w") || !has("h")) {
      if (!sizes) return std::nullopt;
      size = size_in_pixels(*sizes);
      if (!size) return std::nullopt;
    }
    CameraIntrinsics camera;
    camera.width = has("w") ? of("w").at("w").side() : size->width;
    camera.height = has("h") ? of("h").at("h").side() : size->height;
    camera.fx = focal("fl_x", "camera_angle_x", camera.width).value();
    camera.fy = focal("fl_y", "camera_angle_y", camera.height).value_or(camera.fx);
    // The middle of the first pixel is at 0.5 there.
    camera.cx = (has("cx") ? number("cx") : 0.5 * camera.width) - 0.5;
    camera.cy = (has("cy") ? number("cy") : 0.5 * camera.height) - 0.5;
    set_model(camera);
    return camera;
  }

 private:
  /// Of the pictures whose pixels the camera counts: of an angle alone any.
  std::optional<ImageSize> size_in_pixels(const PictureSizes& sizes) const {
    for (const char* key : {"fl_x", "fl_y", "cx", "cy"}) {
      if (!has(key)) continue;
      if (!sizes.colour)
        of(key).at(key).fail("`w` and `h` beside it: the size of the picture whose pixels it counts");
      return sizes.colour;
    }
    return sizes.depth;
  }
  bool has(const char* key) const { return frame_.has(key) || file_.has(key); }
  const PathFields& of(const char* key) const { return frame_.has(key) ? frame_ : file_; }
  double number(const char* key) const { return of(key).at(key).number(); }
  double or_zero(const char* key) const { return has(key) ? number(key) : 0.0; }

  std::optional<double> focal(const char* length, const char* angle, int side) const {
    if (has(length)) {
      if (!(number(length) > 0.0)) of(length).at(length).fail("a focal length > 0, in pixels");
      return number(length);
    }
    if (!has(angle)) return std::nullopt;
    if (!(number(angle) > 0.0 && number(angle) < std::numbers::pi))
      of(angle).at(angle).fail("an angle between 0 and pi");
    return 0.5 * side / std::tan(0.5 * number(angle));
  }
  void set_model(CameraIntrinsics& camera) const {
    const std::string model = has("camera_model") ? of("camera_model").at("camera_model").text() : "OPENCV";
    constexpr std::array<const char*, 5> plumb_bobs{"OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL",
                                                    "RADIAL"};
    const bool is_fisheye =
        model == "OPENCV_FISHEYE" || (has("is_fisheye") && of("is_fisheye").at("is_fisheye").is_true());
    if (!is_fisheye && std::find(plumb_bobs.begin(), plumb_bobs.end(), model) == plumb_bobs.end())
      of("camera_model").at("camera_model").fail("OPENCV, OPENCV_FISHEYE, PINHOLE or RADIAL");
    if (!is_fisheye && or_zero("k4") != 0.0) of("k4").at("k4").fail("0 for a lens that is no fisheye");
    const std::array<double, 4> fisheye{or_zero("k1"), or_zero("k2"), or_zero("k3"), or_zero("k4")};
    const std::array<double, 5> plumb_bob{or_zero("k1"), or_zero("k2"), or_zero("p1"), or_zero("p2"),
                                          or_zero("k3")};
    if (is_fisheye)
      set_lens(camera, LensModel::fisheye, fisheye);
    else
      set_lens(camera, LensModel::plumb_bob, plumb_bob);
  }

  const PathFields &file_, &frame_;
};

}  // namespace

std::optional<CameraIntrinsics> nerf_camera(const PathFields& file, const PathFields& frame,
                                            const std::optional<PictureSizes>& sizes) {
  return NerfCamera(file, frame).read(sizes);
}

bool is_nerf_file(const std::string& text) {
  const std::size_t at = text.find_first_not_of(" \t\r\n", text.starts_with("\xEF\xBB\xBF") ? 3 : 0);
  if (at == std::string::npos || text[at] != '{') return false;
  constexpr std::array<const char*, 2> words{"\"fl_x\"", "\"camera_angle_x\""};
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

CameraIntrinsics camera_of_nerf_file(const std::string& text, const std::string& name,
                                     const std::optional<ImageSize>& size) {
  const PathFields file = PathFields::parse(text, name);
  const std::vector<PathFields> frames = file.has("frames") ? file.at("frames").items() : std::vector{file};
  std::optional<CameraIntrinsics> camera;
  for (const PathFields& frame : frames) {
    const auto own = nerf_camera(file, frame, PictureSizes{size, size});
    if (!own)
      throw std::invalid_argument(
          name +
          ": expected `fl_x` or `camera_angle_x` of its camera, and `w` and `h`, here or "
          "as `width` and `height` beside `file`");
    if (camera && *own != *camera)
      throw std::invalid_argument(name +
                                  ": its pictures have cameras of their own, expected one camera for all");
    camera = own;
  }
  if (!camera) file.fail("at least one frame");
  return *camera;
}

}  // namespace clearway
