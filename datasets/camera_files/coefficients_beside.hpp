#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/camera_files/camera_fields.hpp"

namespace clearway {

/// A map that a camera stands in, and the key there that leads to it.
struct CameraHolder {
  YamlFields fields;
  std::string key;
};

/// Where a lens's coefficients stand: a list, or, without a key, by their names.
struct CoefficientsPlace {
  YamlFields fields;
  std::string key;
};

/// Whether a map is a camera by the names of librealsense, of Open3D, or `fx`, `fy`, `cx`, `cy`.
bool is_realsense(const YamlFields& fields);
bool is_open3d(const YamlFields& fields);
bool is_plain_camera(const YamlFields& fields);

/// The coefficients that stand in one map, at a key; nothing: there are none. @param inner a key of a map of
/// several cameras' @throws std::invalid_argument by YamlFields::fail, where they cannot be read
std::optional<CoefficientsPlace> coefficients_at(const YamlFields& fields, const std::string& key,
                                                 const std::string& inner = "");

/// The coefficients that stand beside a camera and are its own: by words, as `rgbDistortion` beside
/// `rgbIntrinsic`, or, where there is no other camera, as `distortion`.
/// @throws std::invalid_argument by YamlFields::fail, also where they may be its own, or are there twice
std::optional<CoefficientsPlace> coefficients_beside(const std::vector<CameraHolder>& holders);

/// The lens that a map names in which a camera stands, as far as the word means a lens and nothing else.
std::optional<LensModel> lens_of_holder(const YamlFields& fields);

}  // namespace clearway
