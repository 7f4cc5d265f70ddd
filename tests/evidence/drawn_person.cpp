#include "tests/evidence/drawn_person.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <regex>

#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway::evidence {
namespace {

constexpr double to_rad = std::numbers::pi / 180.0;
constexpr double ball_radius = 0.0225;
const Eigen::Vector3d away(0.0, -0.45, 0.12);  // out of the picture

std::string formatted(const char* format, auto... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

/// The places that a sentence names: "(x, y, z)".
std::vector<Eigen::Vector3d> places_in(const std::string& sentence) {
  static const std::regex place(R"(\((-?[0-9.e-]+), (-?[0-9.e-]+), (-?[0-9.e-]+)\))");
  std::vector<Eigen::Vector3d> places;
  for (std::sregex_iterator at(sentence.begin(), sentence.end(), place), end; at != end; ++at)
    places.emplace_back(std::stod((*at)[1]), std::stod((*at)[2]), std::stod((*at)[3]));
  return places;
}

bool says(const std::string& sentence, const std::string& what) {
  return sentence.find(what) != std::string::npos;
}

}  // namespace

double Solid::depth(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d p = Eigen::AngleAxisd(-turn, Eigen::Vector3d::UnitZ()) * (point - center);
  const double up = 0.5 * size.z() - std::abs(p.z());
  if (!is_box) return std::min(size.x() - p.head<2>().norm(), up);
  return std::min((0.5 * size.head<2>() - p.head<2>().cwiseAbs()).minCoeff(), up);
}

std::string Solid::yaml(int number) const {
  if (is_box)
    return formatted(
        "  - {name: solid%d, box: [%.5f, %.5f, %.5f], pose: [%.5f, %.5f, %.5f, 0, 0, %.4f], grey: 110}\n",
        number, size.x(), size.y(), size.z(), center.x(), center.y(), center.z(), turn);
  return formatted(
      "  - {name: solid%d, cylinder: [%.5f, %.5f], pose: [%.5f, %.5f, %.5f, 0, 0, 0], grey: 90}\n", number,
      size.x(), size.z(), center.x(), center.y(), center.z());
}

DrawnPerson::DrawnPerson(std::uint64_t seed) : seed_(seed), random_(seed) {
  first_ = uniform(-65, -40);
  last_ = uniform(40, 65);
  low_ = uniform(52, 70);
  bump_ = uniform(5, 28);
  radius_ = uniform(70, 77);
  is_mistaken_ = uniform(0, 1) < 0.5;
  walks_ = uniform(0, 1) < 0.3;
  sets_down_ = uniform(0, 1) < 0.4;
  exposure_ = uniform(0, 1) < 0.3 ? formatted("%.5f", uniform(0.0, 0.005)) : "0";
  draw_solids();
  for (const double share : {0.04, 0.5, 0.96}) held_.push_back({share, 1e-3 * uniform(2, 7), 0.0});
  begin();
  paint_arc();
  show_and_plan();
}

double DrawnPerson::uniform(double low, double high) {
  return low + (high - low) * static_cast<double>(random_() >> 11U) * 0x1.0p-53;
}

/// The ball's way, mm and degrees to metres.
Eigen::Vector3d DrawnPerson::ball(double share) const {
  const double azimuth = to_rad * (first_ + share * (last_ - first_));
  const double height = low_ + bump_ * std::sin(std::numbers::pi * share);
  return 1e-3 * Eigen::Vector3d(radius_ * std::cos(azimuth), radius_ * std::sin(azimuth), height);
}

void DrawnPerson::draw_solids() {
  const int count = 2 + static_cast<int>(uniform(0, 3));
  for (int i = 0; i < count; ++i) {
    const bool in_the_way = is_mistaken_ && i == 0;
    const double share = uniform(0.2, 0.8);
    const double azimuth =
        in_the_way ? to_rad * (first_ + share * (last_ - first_)) : to_rad * uniform(-80, 80);
    const double off = in_the_way ? 1e-3 * radius_ : uniform(0.05, 0.115);
    Solid solid;
    solid.is_box = uniform(0, 1) < 0.5;
    const double height = in_the_way ? ball(share).z() + uniform(-0.005, 0.015) : uniform(0.01, 0.03);
    solid.size = solid.is_box ? Eigen::Vector3d(uniform(0.012, 0.03), uniform(0.012, 0.03), height)
                              : Eigen::Vector3d(uniform(0.006, 0.014), 0.0, height);
    solid.center = {off * std::cos(azimuth), off * std::sin(azimuth), 0.5 * height};
    solid.turn = solid.is_box ? uniform(0, 3) : 0.0;
    solids_.push_back(solid);
  }
}

void DrawnPerson::act(double time, const std::string& rest) { events_.emplace_back(time, rest); }

void DrawnPerson::lead_ball(double time, const Eigen::Vector3d& place) {
  stroke_ +=
      formatted("    - {time: %.4f, ball: [%.5f, %.5f, %.5f]}\n", time, place.x(), place.y(), place.z());
  now_ = time;
}

/// The depth camera has seen everything once before the probe comes.
void DrawnPerson::begin() {
  act(0.0,
      R"("action":"robot","robot":"puma560_miniature","padding":0.0005,"near":[-1.2973,-0.6329,0.0951,2.7093,0.537,0.2505])");
  const char* wrong[] = {"approve", "play", "paint_off", "erase_off", "clear", "save"};
  for (int i = 0; i < 3; ++i)
    act(uniform(0.0, 2.0), std::string(R"("action":")") + wrong[static_cast<int>(uniform(0, 5))] + "\"");
  lead_ball(0.0, away);
  lead_ball(1.0, away);
}

/// From end to end, with a pause or a rest beside in the middle.
void DrawnPerson::paint_arc() {
  const double duration = uniform(3.5, 5.5);
  const int stop = static_cast<int>(uniform(3, 6));
  lead_ball(now_ + 0.7, ball(0.0));
  act(now_ + 0.05, R"("action":"paint_on")");
  for (int i = 1; i <= 8; ++i) {
    lead_ball(now_ + duration / 8.0, ball(i / 8.0));
    if (i != stop || attempts_ > 0) continue;
    lead_ball(now_ + 0.2, ball(i / 8.0));
    act(now_ - 0.1, R"("action":"paint_off")");
    if (sets_down_) {
      const Eigen::Vector3d beside(0.0, -0.15, 0.05);
      lead_ball(now_ + 0.6, beside);
      lead_ball(now_ + 0.6, beside);
      lead_ball(now_ + 0.6, ball(i / 8.0));
    }
    lead_ball(now_ + 0.1, ball(i / 8.0));
    act(now_, R"("action":"paint_on")");
  }
  lead_ball(now_ + 0.15, ball(1.0));
  act(now_ - 0.05, R"("action":"paint_off")");
  lead_ball(now_ + 0.7, away);
  if (attempts_ == 0 && uniform(0, 1) < 0.15) act(now_, R"("action":"undo")");
}

/// The ball is led to each and turned about a little.
void DrawnPerson::paint_spots(const std::vector<Eigen::Vector3d>& spots) {
  if (spots.empty()) return;
  lead_ball(now_ + 0.7, spots.front());
  for (const Eigen::Vector3d& spot : spots) {
    if ((spot - spots.front()).norm() > 1e-6) lead_ball(now_ + 0.6, spot);
    lead_ball(now_ + 0.2, spot);
    act(now_ - 0.1, R"("action":"paint_on")");
    for (const Eigen::Vector3d& step :
         {Eigen::Vector3d(0.004, 0, 0), Eigen::Vector3d(0, 0.004, 0.004), Eigen::Vector3d(0, 0, 0)})
      lead_ball(now_ + 0.15, spot + step);
    act(now_ + 0.02, R"("action":"paint_off")");
    lead_ball(now_ + 0.1, spot);
  }
  lead_ball(now_ + 0.7, away);
}

void DrawnPerson::show_and_plan() {
  const Eigen::Vector3d put(0.0, 0.45, 0.12);
  const auto hold = [&](double time, const Eigen::Vector3d& tip, double azimuth) {
    gripper_ += formatted("    - {time: %.3f, tip_deg: [%.5f, %.5f, %.5f, 0, 90, %.3f]}\n", time, tip.x(),
                          tip.y(), tip.z(), azimuth / to_rad);
  };
  double time = now_;
  hold(time, put, std::numbers::pi / 2.0);
  time += 0.7;
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const Eigen::Vector3d at = ball(held_[i].share);
    const double azimuth = std::atan2(at.y(), at.x());
    const Eigen::Vector3d tip = at +
                                held_[i].out * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0) +
                                Eigen::Vector3d(0.0, 0.0, held_[i].up);
    hold(time, tip, azimuth);
    hold(time + 0.8, tip, azimuth);
    const char* names[] = {"start", "via", "goal"};
    if (i != 1 || seed_ % 2 == 0) act(time + 0.7, std::string(R"("action":")") + names[i] + "\"");
    time += 1.5;
  }
  time -= 0.7;
  const std::string planner = seed_ % 3 == 0 ? "boundary_plus" : "beam";
  act(time + 0.05,
      formatted(R"("action":"plan","name":"drawn%d","planner":"%s")", attempts_, planner.c_str()));
  act(time + 0.1, R"("action":"approve")");
  hold(time + 0.7, put, std::numbers::pi / 2.0);
  now_ = time + 0.8;
  lead_ball(now_, away);
}

/// The person does not push the ball into what stands there.
Eigen::Vector3d DrawnPerson::clear_of_solids(Eigen::Vector3d place) const {
  place.z() = std::max(place.z(), ball_radius + 0.002);
  for (int step = 0; step < 30; ++step) {
    const bool is_clear = std::all_of(solids_.begin(), solids_.end(), [&](const Solid& solid) {
      return solid.depth(place) < -(ball_radius + 0.001);
    });
    if (is_clear) break;
    place.z() += 0.002;
  }
  return place;
}

void DrawnPerson::try_again(const std::vector<Answer>& answers) {
  ++attempts_;
  attempt_begins_ = now_ + 1e-3;
  std::vector<Eigen::Vector3d> spots;
  bool leads_arc = false;
  for (const Answer& answer : answers) {
    const bool is_place = answer.action == "start" || answer.action == "via" || answer.action == "goal";
    const std::vector<Eigen::Vector3d> places = places_in(answer.sentence);
    if (is_place) {
      Held& held = held_[answer.action == "start" ? 0 : answer.action == "via" ? 1 : 2];
      const bool touches = says(answer.sentence, "touches");
      held.out -= touches ? 0.0 : 0.003;
      if (touches) held.up += 0.006;
      if (!places.empty() && !touches) spots.push_back(clear_of_solids(places.front()));
      if (touches) spots.push_back(clear_of_solids(ball(held.share) + Eigen::Vector3d(0, 0, held.up)));
    } else if (answer.action == "plan") {
      leads_arc = leads_arc || places.empty();
      for (const Eigen::Vector3d& place : places) spots.push_back(clear_of_solids(place));
    }
  }
  constexpr std::size_t most_spots = 6;
  if (spots.size() > most_spots) spots.resize(most_spots);
  if (leads_arc) {
    bump_ += 10.0;
    paint_arc();
  }
  paint_spots(spots);
  show_and_plan();
}

std::string DrawnPerson::setup() const {
  std::string text =
      read_file(std::filesystem::path(datasets_folder()) / "setups" / "miniature_kitchen.yaml");
  const auto put = [&](const std::string& from, const std::string& by) {
    text.replace(text.find(from), from.size(), by);
  };
  const std::string hand =
      "  hand: [{from: [0.012, 0, -0.05], to: [0.06, 0, -0.03], radius: 0.01}, "
      "{from: [0.06, 0, -0.03], to: [0.12, 0, 0.06], radius: 0.03}]\n";
  put("  tracking_error: 0.0019\n", "  tracking_error: 0.0019\n" + hand);
  put("  tip: [0, 0, 0.090, 0, 0, 0]\n",
      "  tip: [0, 0, 0.090, 0, 0, 0]\n  hand: [{from: [0.03, 0, -0.01], to: [0.08, 0, -0.05], radius: "
      "0.02}]\n");
  if (walks_) put("  fixed_camera: true\n", "");
  return text;
}

std::string DrawnPerson::scene() const {
  const std::filesystem::path datasets = datasets_folder();
  std::string text = read_file(datasets / "scenes" / "miniature_kitchen.yaml");
  const auto cut = [&](const std::string& from, const std::string& to, const std::string& by) {
    const std::size_t a = text.find(from), b = to.empty() ? text.size() : text.find(to, a + 1);
    text = text.substr(0, a) + by + text.substr(b);
  };
  std::string solids;
  for (std::size_t i = 0; i < solids_.size(); ++i) solids += solids_[i].yaml(static_cast<int>(i));
  cut("  - {name: box,", "\ncamera:", solids);
  cut("stroke:\n", "",
      "stroke:\n  person: any\n  orientation_deg: [0, -14, 32]\n  waypoints:\n" + stroke_ +
          "gripper:\n  waypoints:\n" + gripper_ + "hands:\n  cover_share: 0.12\n");
  cut("setup: ", "\nseed", "setup: setup.yaml");
  cut("seed: 1", "\nbackground", "seed: " + std::to_string(seed_));
  cut("rate_hz: 15", "\n  noise_sigma",
      "rate_hz: 8\n  exposure: " + (walks_ ? "0" : exposure_) +
          "\n  errors: {brightness: 0.3, noise: 0.5, dropped: 0.04, "
          "repeated: 0.02}");
  if (walks_) {
    std::string path = "path:\n";
    for (int i = 0; i <= 6; ++i) {
      const double angle = 0.5 * std::sin(i * std::numbers::pi / 3.0);
      path += formatted("    - {time: %.3f, look_at: {eye: [%.4f, %.4f, 0.38], target: [0.045, 0, 0.075]}}\n",
                        now_ * i / 6.0, 0.045 - 0.345 * std::cos(angle), 0.345 * std::sin(angle));
    }
    cut("look_at: {eye: [-0.300", "  rate_hz", path + "  sway: {shift: 0.0003, turn_deg: 0.1}\n");
  }
  cut("  noise_constant: 0.0002", "  dropout",
      "  noise_constant: 0.0002\n  noise_quadratic: 0.001\n  interval: "
      "0.5\n  beside_pictures: true\n");
  return text;
}

std::string DrawnPerson::events() const {
  std::vector<std::pair<double, std::string>> events = events_;
  std::stable_sort(events.begin(), events.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string text;
  for (const auto& [time, rest] : events) text += "{\"time\":" + std::to_string(time) + "," + rest + "}\n";
  return text;
}

}  // namespace clearway::evidence
