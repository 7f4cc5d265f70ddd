#include "planning/files/query_record.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/json_text.hpp"
#include "planning/files/load_json.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* format = "clearway queries 1";
constexpr std::size_t most_bytes = 16U << 20;

constexpr const char* axes[] = {"x", "y", "z"};

double tolerance_of(const JsonField& field) {
  const double value = field.number();
  if (!(value >= 0.0 && value <= 10.0)) field.refuse("a number from 0 to 10");
  return value;
}

GoalPose goal_of(const JsonField& field) {
  GoalPose goal{pose_of(field.at("pose")), tolerance_of(field.at("position_tolerance_m")),
                tolerance_of(field.at("turn_tolerance_rad"))};
  if (!field.has("free_axis")) return goal;
  const std::string name = field.at("free_axis").text();
  const auto axis = std::find(std::begin(axes), std::end(axes), name);
  if (axis == std::end(axes)) field.at("free_axis").refuse("x, y or z");
  goal.free_axis = static_cast<int>(axis - std::begin(axes));
  return goal;
}

Json terms_json(const QueryTerms& query) {
  Json json = {{"name", query.name},
               {"robot", query.robot},
               {"scale", query.scale},
               {"base", json_of(query.map_from_base)},
               {"policy", json_of(query.policies)},
               {"padding_m", query.padding},
               {"seen_within_s", query.seen_within},
               {"allow_outside", query.allow_outside},
               {"start", json_of(query.start)},
               {"goals", json_of(query.goals)}};
  for (const GoalPose& goal : query.goal_poses) json["goal_poses"].push_back(json_of(goal));
  if (!query.tip.empty()) json["tip"] = query.tip;
  if (!query.loads.empty()) json["loads"] = json_of(query.loads);
  if (query.pick) json["pick"] = json_of(*query.pick);
  if (query.payload) json["payload_kg"] = *query.payload;
  if (query.gravity) json["gravity"] = json_of(Eigen::VectorXd(*query.gravity));
  if (!query.joints.empty()) json["joints"] = query.joints;
  return json;
}

QueryTerms terms_of(const JsonField& field) {
  QueryTerms query;
  query.name = field.at("name").text();
  query.robot = field.at("robot").text();
  query.scale = scale_of(field.at("scale"));
  query.map_from_base = pose_of(field.at("base"));
  query.policies = policies_of(field.at("policy"));
  query.padding = padding_of(field.at("padding_m"));
  if (field.has("seen_within_s")) query.seen_within = seen_within_of(field.at("seen_within_s"));
  if (field.has("allow_outside")) {
    for (const JsonField& part : field.at("allow_outside").items())
      query.allow_outside.push_back(part.text());
  }
  const std::size_t joints = field.at("start").items().size();
  query.start = field.at("start").numbers(joints);
  query.goals = field.at("goals").vectors(joints);
  if (field.has("goal_poses"))
    for (const JsonField& goal : field.at("goal_poses").items()) query.goal_poses.push_back(goal_of(goal));
  if (field.has("tip")) query.tip = field.at("tip").text();
  if (field.has("pick")) query.pick = pick_of(field.at("pick"));
  if (field.has("loads")) query.loads = loads_of(field.at("loads"));
  if (field.has("payload_kg")) query.payload = payload_of(field.at("payload_kg"));
  if (field.has("gravity")) query.gravity = gravity_of(field.at("gravity"));
  if (field.has("joints")) {
    for (const JsonField& joint : field.at("joints").items()) query.joints.push_back(joint.text());
    if (query.joints.size() != joints)
      field.at("joints").refuse("as many as 'start' has values, " + std::to_string(joints));
  }
  return query;
}

/// The checksum is of the file's text with zeros in its own place.
const std::string no_checksum(64, '0');

/// @throws std::invalid_argument for what is no JSON with a checksum.
bool is_whole(std::string text, const std::string& file) {
  require_json(text, file);
  const Json json = Json::parse(text);
  const std::string checksum = JsonField(json, file).at("sha256").text();
  const std::size_t place = text.rfind(checksum);
  if (checksum.size() != no_checksum.size() || place == std::string::npos) return false;
  return sha256(text.replace(place, checksum.size(), no_checksum)) == checksum;
}

void require_whole(const std::string& text, const std::string& file) {
  try {
    if (is_whole(text, file)) return;
  } catch (const std::invalid_argument&) {
    // Something of the file is no longer what was written: that is all there is to say.
  }
  throw DamagedFile(file + ": is damaged: its checksum does not match its content");
}

}  // namespace

nlohmann::ordered_json json_of(const GoalPose& goal) {
  Json json = {{"pose", json_of(goal.map_from_tip)},
               {"position_tolerance_m", goal.position_tolerance},
               {"turn_tolerance_rad", goal.turn_tolerance}};
  if (goal.free_axis) json["free_axis"] = axes[*goal.free_axis];
  return json;
}

double largest_difference(const Configuration& a, const Configuration& b) {
  if (a.size() != b.size() || !a.allFinite() || !b.allFinite())
    return std::numeric_limits<double>::infinity();
  return a.size() == 0 ? 0.0 : (a - b).cwiseAbs().maxCoeff();
}

const QueryTerms* QueryRecord::find(const std::string& name, const Configuration& start,
                                    const std::vector<Configuration>& goals, double tolerance) const {
  for (const QueryTerms& query : queries) {
    if (!name.empty() && query.name == name) return &query;
  }
  for (const QueryTerms& query : queries) {
    bool is_equal = query.goals.size() == goals.size() && largest_difference(query.start, start) <= tolerance;
    for (std::size_t i = 0; is_equal && i < goals.size(); ++i)
      is_equal = largest_difference(query.goals[i], goals[i]) <= tolerance;
    if (is_equal) return &query;
  }
  return nullptr;
}

const QueryTerms* QueryRecord::find_whole(const Configuration& start, const std::vector<Configuration>& goals,
                                          double tolerance) const {
  const auto is_part = [&](const QueryTerms& query) {
    std::vector<Configuration> stops{query.start};
    stops.insert(stops.end(), query.goals.begin(), query.goals.end());
    const auto is_at = [&](const Configuration& q) {
      return [&](const Configuration& stop) { return largest_difference(stop, q) <= tolerance; };
    };
    auto at = std::find_if(stops.begin(), stops.end(), is_at(start));
    return at != stops.end() && std::all_of(goals.begin(), goals.end(), [&](const Configuration& goal) {
             at = std::find_if(std::next(at), stops.end(), is_at(goal));
             return at != stops.end();
           });
  };
  const auto found = std::find_if(queries.begin(), queries.end(), is_part);
  return found == queries.end() ? nullptr : &*found;
}

std::string to_json(const QueryRecord& record) {
  Json json = {{"format", format}, {"map_sha256", record.map_sha256}};
  if (!record.made_for.empty()) json["made_for_sha256"] = record.made_for;
  json["queries"] = Json::array();
  for (const QueryTerms& query : record.queries) json["queries"].push_back(terms_json(query));
  json["sha256"] = no_checksum;
  // Bytes that are not UTF-8 (a robot's path) are replaced rather than refused.
  std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::string checksum = sha256(text);
  return text.replace(text.rfind(no_checksum), checksum.size(), checksum);
}

namespace {

constexpr const char* record_name = "queries.json";

QueryRecord parse_record(const std::string& text, const std::filesystem::path& file) {
  require_whole(text, file.string());
  const Json json = Json::parse(text);
  const JsonField root(json, file.string());
  if (root.at("format").text() != format) root.at("format").refuse("'" + std::string(format) + "'");
  QueryRecord record;
  record.map_sha256 = root.at("map_sha256").text();
  if (root.has("made_for_sha256")) record.made_for = root.at("made_for_sha256").text();
  for (const JsonField& query : root.at("queries").items()) record.queries.push_back(terms_of(query));
  return record;
}

/// Where a map's record would be.
std::filesystem::path file_of_record(const std::filesystem::path& map) {
  std::error_code error;
  return (std::filesystem::is_directory(map, error) ? map : map.parent_path()) / record_name;
}

}  // namespace

FileBeside record_beside() { return {record_name, "queries", most_bytes}; }

std::optional<QueryRecord> record_of(const LoadedMap& loaded, const std::filesystem::path& map) {
  const auto found = loaded.beside.find(record_name);
  if (found == loaded.beside.end()) return {};
  return parse_record(found->second, file_of_record(map));
}

std::optional<QueryRecord> record_to_hand_on(const LoadedMap& loaded, const std::filesystem::path& map) {
  std::optional<QueryRecord> record = record_of(loaded, map);
  if (!record || record->map_sha256 != loaded.sha256) return {};
  record->made_for = record->map_sha256;
  return record;
}

std::string record_aside(const std::filesystem::path& map) {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(map, error);
  const std::filesystem::path file = is_folder ? map / "map.ot" : map;
  if (!std::filesystem::is_symlink(std::filesystem::symlink_status(file, error))) return {};
  const std::filesystem::path there = std::filesystem::canonical(file, error);
  if (error || there.filename() != "map.ot") return {};
  const std::filesystem::path other = there.parent_path() / record_name, own = file_of_record(map);
  const bool is_named = is_folder || map.filename() == "map.ot";  // else it has none of its own
  if (!std::filesystem::exists(other, error)) return {};
  if (is_named && std::filesystem::exists(own, error)) return {};  // which has a digest of its map
  return quote_path(file.string()) + " leads to " + quote_path(there.string()) +
         ", whose folder has a record of queries that does not count here: name that folder to be held to it";
}

RecordedMap load_recorded_map(const std::filesystem::path& map, std::optional<double> cloud_resolution) {
  LoadedMap loaded = load_map_with(map, {record_beside()}, cloud_resolution);
  std::optional<QueryRecord> record = record_of(loaded, map);
  return {std::move(loaded.map), std::move(loaded.sha256), std::move(record)};
}

std::optional<QueryRecord> load_query_record(const std::filesystem::path& map) {
  std::error_code error;
  if (!std::filesystem::is_directory(map, error) && map.filename() != "map.ot") return {};
  const std::filesystem::path file = file_of_record(map);
  if (!std::filesystem::exists(std::filesystem::symlink_status(file, error))) return {};
  return parse_record(read_input(file, "queries", most_bytes), file);
}

}  // namespace clearway
