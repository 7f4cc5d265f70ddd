#include "apps/track/pose_text.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

/// A text as one field of a CSV (RFC 4180).
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string finite(double value) { return std::isfinite(value) ? to_text(value) : "inf"; }

std::string line_begin(const ImagePoses& image) {
  return to_text(image.time) + "," + field(image.file) + ",";
}

/// x, y, z, qw, qx, qy, qz, with qw >= 0.
std::vector<double> pose_numbers(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  const double sign = turn.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d& at = pose.translation();
  return {at.x(), at.y(), at.z(), sign * turn.w(), sign * turn.x(), sign * turn.y(), sign * turn.z()};
}

constexpr int pose_columns = 7, covariance_columns = 21;

std::string pose_fields(const std::optional<UncertainPose>& pose) {
  if (!pose) return std::string(pose_columns + covariance_columns, ',');
  std::string text;
  for (const double value : pose_numbers(pose->pose)) text += "," + to_text(value);
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column) text += "," + to_text(pose->covariance(row, column));
  return text;
}

std::string list_of_tags(const std::vector<int>& tags) {
  std::string list;
  for (const int id : tags) list += (list.empty() ? "" : " ") + std::to_string(id);
  return list;
}

std::string bound_fields(const std::optional<CenterBound>& bound) {
  if (!bound) return std::string(6, ',');
  std::string text;
  for (const double value :
       {bound->total, bound->noise, bound->tilt, bound->camera, bound->tags, bound->edges})
    text += "," + to_text(value);
  return text;
}

std::string list_of_left_out(const std::vector<LeftOutTag>& tags) {
  std::string list;
  for (const LeftOutTag& tag : tags)
    list += (list.empty() ? "" : " ") + std::to_string(tag.id) + ":" + tag.reason;
  return list;
}

Json json_of(const ImagePose& pose) {
  Json json{{"kind", pose.kind}, {"name", pose.name}, {"frame", pose.frame}};
  json["status"] = pose.is_accepted() ? "accepted" : pose.refusal;
  if (!pose.is_accepted()) json["reason"] = pose.reason;
  json["tags"] = pose.tags;
  for (const LeftOutTag& tag : pose.left_out)
    json["left_out"].push_back({{"id", tag.id}, {"reason", tag.reason}});
  if (!pose.pose) return json;
  json["pose"] = pose_numbers(pose.pose->pose);
  for (int row = 0; row < 6; ++row) {
    const Vector6d numbers =
        0.5 * (pose.pose->covariance.row(row).transpose() + pose.pose->covariance.col(row));  // of rounding
    json["covariance"].push_back(std::vector<double>(numbers.data(), numbers.data() + 6));
  }
  json["rms_px"] = pose.rms_px.value_or(0.0);
  json["ambiguity"] = std::isfinite(pose.ambiguity) ? Json(pose.ambiguity) : Json(nullptr);
  if (const auto& bound = pose.bound) {
    json["bound"] = bound->total;
    json["bound_by"] = {{"noise", bound->noise},
                        {"tilt", bound->tilt},
                        {"camera", bound->camera},
                        {"tags", bound->tags},
                        {"edges", bound->edges}};
  }
  return json;
}

}  // namespace

std::string poses_csv_header() {
  std::string text = "time,file,kind,name,frame,status,reason,tags,rms_px,ambiguity,x,y,z,qw,qx,qy,qz";
  for (int row = 1; row <= 6; ++row)
    for (int column = row; column <= 6; ++column) text += ",c" + std::to_string(row) + std::to_string(column);
  return text + ",bound,bound_noise,bound_tilt,bound_camera,bound_tags,bound_edges,left_out\n";
}

std::string to_csv(const ImagePoses& image) {
  if (image.poses.empty()) {
    const bool is_refused = !image.refusal.empty();
    return line_begin(image) + "image,,," + (is_refused ? "image_refused," : "no_tag,") +
           field(is_refused ? image.refusal : "no tag is seen") + ",,," + pose_fields({}) + bound_fields({}) +
           ",\n";
  }
  std::string text;
  for (const ImagePose& pose : image.poses) {
    text += line_begin(image) + pose.kind + "," + field(pose.name) + "," + pose.frame + "," +
            (pose.is_accepted() ? "accepted" : pose.refusal) + "," + field(pose.reason) + "," +
            list_of_tags(pose.tags) + "," + (pose.rms_px ? to_text(*pose.rms_px) : "") + "," +
            (pose.rms_px ? finite(pose.ambiguity) : "") + pose_fields(pose.pose) + bound_fields(pose.bound) +
            "," + list_of_left_out(pose.left_out) + "\n";
  }
  return text;
}

std::string to_json(const ImagePoses& image) {
  Json json{{"time", image.time}};
  if (!image.file.empty()) json["file"] = image.file;
  json["width"] = image.width;
  json["height"] = image.height;
  if (!image.refusal.empty()) json["refusal"] = image.refusal;
  json["detections"] = Json::array();
  for (const TagDetection& tag : image.tags) {
    Json corners = Json::array();
    for (const Eigen::Vector2d& corner : tag.corners) corners.push_back({corner.x(), corner.y()});
    json["detections"].push_back({{"id", tag.id},
                                  {"hamming", tag.hamming},
                                  {"margin", tag.decision_margin},
                                  {"corners", std::move(corners)}});
  }
  json["poses"] = Json::array();
  for (const ImagePose& pose : image.poses) json["poses"].push_back(json_of(pose));
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string tum_line(double time, const Eigen::Isometry3d& pose) {
  const std::vector<double> v = pose_numbers(pose);
  std::string line = to_text(time);
  for (const int i : {0, 1, 2, 4, 5, 6, 3}) line += " " + to_text(v[static_cast<std::size_t>(i)]);
  return line + "\n";
}

}  // namespace clearway
