#include "planning/robot_files/srdf_file.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/tip_choice.hpp"
#include "planning/robot_files/urdf_document.hpp"

namespace clearway {
namespace {

using XmlElement = tinyxml2::XMLElement;

constexpr std::size_t most_srdf_pairs = 100'000;
constexpr std::size_t most_srdf_groups = 1000, most_srdf_entries = 100'000;

constexpr const char* blanks = " \t\r\n";

/// As srdfdom takes names and values.
std::string without_blanks_around(const std::string& text) {
  const std::size_t begin = std::min(text.find_first_not_of(blanks), text.size());
  return text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

[[noreturn]] void refuse_srdf(const std::filesystem::path& file, const std::string& what) {
  throw std::invalid_argument(file.string() + ": " + what);
}

/// Reads elements one by one; knows the file.
class SrdfReader {
 public:
  explicit SrdfReader(const std::filesystem::path& file) : file_(file) {}

  Srdf read(const XmlElement& robot) {
    check_names(robot);
    srdf_.robot = optional(robot, "name");
    each(robot, "group", [&](const XmlElement& e) { add_group(e); });
    each(robot, "group_state", [&](const XmlElement& e) { add_state(e); });
    each(robot, "end_effector", [&](const XmlElement& e) {
      srdf_.end_effectors.push_back({attribute(e, "name"), attribute(e, "parent_link"), optional(e, "group"),
                                     optional(e, "parent_group")});
    });
    each(robot, "passive_joint",
         [&](const XmlElement& e) { srdf_.passive_joints.insert(attribute(e, "name")); });
    each(robot, "virtual_joint", [&](const XmlElement& e) {
      srdf_.virtual_joints[attribute(e, "name")] = optional(e, "type");
      srdf_.outer_frames.insert(optional(e, "parent_frame"));
    });
    each(robot, "disable_collisions", [&](const XmlElement& e) { srdf_.disabled.push_back(pair_of(e)); });
    each(robot, "enable_collisions", [&](const XmlElement& e) { srdf_.enabled.push_back(pair_of(e)); });
    each(robot, "disable_default_collisions",
         [&](const XmlElement& e) { srdf_.disabled_links.push_back(attribute(e, "link")); });
    if (srdf_.disabled.size() > most_srdf_pairs || srdf_.enabled.size() > most_srdf_pairs)
      refuse_srdf(file_, "has more than 100,000 <disable_collisions>");
    return std::move(srdf_);
  }

 private:
  template <class Visit>
  void each(const XmlElement& parent, const char* name, const Visit& visit) const {
    for (const auto* child = parent.FirstChildElement(name); child; child = child->NextSiblingElement(name))
      visit(*child);
  }

  void check_names(const XmlElement& robot) const {
    const std::vector<std::string> known{"disable_collisions",
                                         "enable_collisions",
                                         "disable_default_collisions",
                                         "group",
                                         "group_state",
                                         "end_effector",
                                         "passive_joint",
                                         "virtual_joint"};
    for (const auto* entry = robot.FirstChildElement(); entry; entry = entry->NextSiblingElement()) {
      const std::string meant = misspelt_name(entry->Name(), known);
      if (!meant.empty())
        refuse_srdf(file_,
                    "unknown element <" + shortened(entry->Name()) + ">, did you mean <" + meant + ">?");
    }
  }

  std::string attribute(const XmlElement& element, const char* name) const {
    std::string value = optional(element, name);
    if (value.empty()) refuse_srdf(file_, std::string("<") + element.Name() + "> needs " + name + "=…");
    return value;
  }

  static std::string optional(const XmlElement& element, const char* name) {
    const char* value = element.Attribute(name);
    return value ? without_blanks_around(value) : "";
  }

  std::pair<std::string, std::string> pair_of(const XmlElement& element) const {
    if (!element.Attribute("link1") || !element.Attribute("link2"))
      refuse_srdf(file_, std::string("<") + element.Name() + "> needs link1 and link2");
    return {optional(element, "link1"), optional(element, "link2")};
  }

  void count_entry() {
    if (++entries_ > most_srdf_entries)
      refuse_srdf(file_, "has more than 100,000 entries in its groups and states");
  }

  void add_group(const XmlElement& element) {
    const std::string name = attribute(element, "name");
    const auto [group, is_new] = srdf_.groups.try_emplace(name);
    if (!is_new) {
      group->second.fault = "group " + quote(name) + " is defined twice";
      return;
    }
    if (srdf_.groups.size() > most_srdf_groups) refuse_srdf(file_, "has more than 1000 groups");
    for (const auto* child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
      const std::string kind = child->Name();
      count_entry();
      if (kind == "link")
        group->second.links.push_back(attribute(*child, "name"));
      else if (kind == "joint" || kind == "passive_joint")
        group->second.joints.push_back(attribute(*child, "name"));
      else if (kind == "chain")
        group->second.chains.emplace_back(attribute(*child, "base_link"), attribute(*child, "tip_link"));
      else if (kind == "group")
        group->second.groups.push_back(attribute(*child, "name"));
      else
        group->second.fault =
            "group " + quote(name) + " holds <" + shortened(kind) + ">, expected link, joint, chain or group";
    }
  }

  void add_state(const XmlElement& element) {
    Srdf::State state;
    state.name = attribute(element, "name");
    state.group = optional(element, "group");
    if (state.group.empty()) {
      srdf_.states_of_no_group.push_back(state.name);
      return;
    }
    each(element, "joint", [&](const XmlElement& joint) {
      count_entry();
      const std::string name = attribute(joint, "name"), written = attribute(joint, "value");
      const std::string where = "joint " + quote(name) + " of state " + quote(state.name);
      const std::string& text = written;
      if (text.find_first_of(blanks) != std::string::npos) {  // as a virtual joint has several
        srdf_.several.emplace_back(state.name, name);
        return;
      }
      if (text.empty()) refuse_srdf(file_, where + " has no value, expected a finite number");
      double value = 0.0;
      const char* first = text.data() + (text.front() == '+' ? 1 : 0);
      const auto [stop, error] = std::from_chars(first, text.data() + text.size(), value);
      if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value))
        refuse_srdf(file_, where + " has the value " + quote(text) + ", expected a finite number");
      if (!state.values.emplace(name, value).second) refuse_srdf(file_, where + " has two values");
    });
    srdf_.states.push_back(std::move(state));
  }

  const std::filesystem::path& file_;
  Srdf srdf_;
  std::size_t entries_ = 0;
};

/// Collects the joints of a group; knows robot and file.
class GroupJoints {
 public:
  GroupJoints(const Robot& robot, const Srdf& srdf, const std::filesystem::path& file)
      : robot_(robot), srdf_(srdf), file_(file) {}

  std::set<std::string> of(const std::string& group) {
    add(group);
    if (joints_.empty()) refuse_srdf(file_, "group " + quote(group) + " has no joint that moves");
    return std::move(joints_);
  }

 private:
  void add(const std::string& name) {
    const auto group = srdf_.groups.find(name);
    if (group == srdf_.groups.end()) {
      std::vector<std::string> names;
      std::string list;
      for (const auto& [known, ignored] : srdf_.groups) {
        names.push_back(known);
        list += (list.empty() ? "" : ", ") + known;
      }
      refuse_srdf(file_, "there is no group " + quote(name) +
                             (list.empty() ? ", nor any other" : ", expected one of " + shortened(list)));
    }
    if (!group->second.fault.empty()) refuse_srdf(file_, group->second.fault);
    if (!seen_.insert(name).second) return;  // twice, or within itself: nothing new
    for (const std::string& link : group->second.links) add_link(link_index(name, link));
    for (const std::string& joint : group->second.joints) add_joint(name, joint);
    for (const auto& [base, tip] : group->second.chains) add_chain(name, base, tip);
    for (const std::string& other : group->second.groups) add(other);
  }

  std::size_t link_index(const std::string& group, const std::string& name) const {
    for (std::size_t i = 0; i < robot_.links.size(); ++i)
      if (robot_.links[i].name == name) return i;
    refuse_srdf(file_, "group " + quote(group) + " names link " + quote(name) + ", which " + robot_.name +
                           " does not have");
  }

  /// The joint above a link, when it moves by itself.
  void add_link(std::size_t link) {
    const Link& at = robot_.links[link];
    if (at.joint < 0 || srdf_.passive_joints.contains(at.joint_name)) return;
    if (robot_.joints[static_cast<std::size_t>(at.joint)].name == at.joint_name)
      joints_.insert(at.joint_name);
  }

  void add_joint(const std::string& group, const std::string& joint) {
    for (std::size_t i = 0; i < robot_.links.size(); ++i)
      if (robot_.links[i].joint_name == joint) return add_link(i);
    const auto known = srdf_.virtual_joints.find(joint);
    if (known == srdf_.virtual_joints.end())
      refuse_srdf(file_, "group " + quote(group) + " names joint " + quote(joint) + ", which " + robot_.name +
                             " does not have");
    if (known->second != "fixed")
      refuse_srdf(file_, "group " + quote(group) + " moves the base by virtual joint " + quote(joint) +
                             " of type " + quote(known->second) + ", expected a base that stands");
  }

  /// All joints between two links, over the link at which their ways to the root meet.
  void add_chain(const std::string& group, const std::string& base, const std::string& tip) {
    std::set<int> above;  // the links above base, itself included
    for (int i = static_cast<int>(link_index(group, base)); i >= 0;
         i = robot_.links[static_cast<std::size_t>(i)].parent)
      above.insert(i);
    int at = static_cast<int>(link_index(group, tip));
    for (; !above.contains(at); at = robot_.links[static_cast<std::size_t>(at)].parent)
      add_link(static_cast<std::size_t>(at));
    const int meeting = at;
    for (at = static_cast<int>(link_index(group, base)); at != meeting;
         at = robot_.links[static_cast<std::size_t>(at)].parent)
      add_link(static_cast<std::size_t>(at));
  }

  const Robot& robot_;
  const Srdf& srdf_;
  const std::filesystem::path& file_;
  std::set<std::string> joints_, seen_;
};

}  // namespace

Srdf read_srdf(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  tinyxml2::XMLDocument xml;
  const bool parsed = xml.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS;
  const XmlElement* robot = parsed ? xml.FirstChildElement("robot") : nullptr;
  if (!robot) refuse_srdf(file, "is not a SRDF, expected XML with a <robot> element");
  return SrdfReader(file).read(*robot);
}

std::vector<std::pair<std::string, std::string>> untested_pairs(const Srdf& srdf,
                                                                const std::vector<std::string>& links) {
  const std::set<std::string> known(links.begin(), links.end());
  std::set<std::pair<std::string, std::string>> pairs;
  for (const std::string& link : srdf.disabled_links) {
    if (!known.contains(link)) continue;
    for (const std::string& other : known)
      if (other != link) pairs.insert(std::minmax(link, other));
  }
  for (const auto& [first, second] : srdf.enabled) pairs.erase(std::minmax(first, second));
  for (const auto& [first, second] : srdf.disabled)
    if (known.contains(first) && known.contains(second)) pairs.insert(std::minmax(first, second));
  return {pairs.begin(), pairs.end()};
}

std::vector<std::pair<std::string, std::string>> tested_pairs(const Srdf& srdf,
                                                              const std::vector<std::string>& links) {
  const std::set<std::string> known(links.begin(), links.end());
  std::set<std::pair<std::string, std::string>> pairs;
  for (const auto& [first, second] : srdf.enabled)
    if (known.contains(first) && known.contains(second)) pairs.insert(std::minmax(first, second));
  for (const auto& [first, second] : srdf.disabled) pairs.erase(std::minmax(first, second));
  return {pairs.begin(), pairs.end()};
}

std::vector<std::string> srdf_notes(const Robot& robot) {
  std::vector<std::string> notes;
  if (robot.srdf.empty()) return notes;
  const Srdf srdf = read_srdf(robot.srdf);
  const std::string called = "the SRDF " + quote_path(robot.srdf.string());
  if (!srdf.robot.empty() && !robot.model.empty() && srdf.robot != robot.model)
    notes.push_back(called + " is for robot " + quote(srdf.robot) + ", the URDF's robot is called " +
                    quote(robot.model));
  if (!srdf.states_of_no_group.empty())
    notes.push_back(called +
                    " is read without its states that name no group: " + listed(srdf.states_of_no_group));
  for (const auto& [state, joint] : srdf.several)
    if (std::any_of(robot.links.begin(), robot.links.end(),
                    [&name = joint](const Link& link) { return link.joint_name == name; }))
      notes.push_back(called + " is read without what state " + quote(state) + " says of joint " +
                      quote(joint) + ": several values, expected one");
  std::set<std::string> unknown(srdf.disabled_links.begin(), srdf.disabled_links.end());
  for (const auto* pairs : {&srdf.disabled, &srdf.enabled})
    for (const auto& [first, second] : *pairs) unknown.insert({first, second});
  const std::vector<Srdf::EndEffector> effectors = end_effectors_of_group(robot, srdf);
  std::vector<std::string> hands;
  for (const Srdf::EndEffector& effector : effectors)
    hands.push_back(quote(effector.name) + " on link " + quote(effector.parent_link));
  const std::string& tip = robot.links.at(static_cast<std::size_t>(robot.tip_link)).name;
  if (hands.size() > 1 && effectors.front().parent_link == tip)
    notes.push_back(called + " has several end effectors of group " + quote(robot.group) +
                    ", and the first is the tip; --tip chooses another: " + listed(hands));
  for (const Link& link : robot.links) unknown.erase(link.name);
  if (!unknown.empty())
    notes.push_back(called + " names " + std::to_string(unknown.size()) +
                    (unknown.size() == 1 ? " link" : " links") +
                    " in pairs without a test that the robot does "
                    "not have: " +
                    listed({unknown.begin(), unknown.end()}));
  return notes;
}

std::set<std::string> joints_of_group(const Robot& robot, const Srdf& srdf, const std::string& group,
                                      const std::filesystem::path& file) {
  return GroupJoints(robot, srdf, file).of(group);
}

std::string link_of_tip(const Robot& robot, const std::string& name) {
  const auto is_called = [&](const auto& named) { return named.name == name; };
  if (robot.srdf.empty() || std::any_of(robot.links.begin(), robot.links.end(), is_called)) return name;
  const Srdf srdf = read_srdf(robot.srdf);
  const auto effector = std::find_if(srdf.end_effectors.begin(), srdf.end_effectors.end(), is_called);
  return effector == srdf.end_effectors.end() ? name : effector->parent_link;
}

std::vector<NamedState> states_of(const Srdf& srdf, const std::string& group) {
  std::map<std::string, NamedState> states;
  std::map<std::pair<std::string, std::string>, std::string>
      owners;                 // the group that says it, by state, joint
  std::set<std::string> own;  // names of states of `group`
  for (const bool is_own : {true, false}) {
    for (const Srdf::State& state : srdf.states) {
      if ((state.group == group) != is_own) continue;
      if (is_own) own.insert(state.name);
      NamedState& known = states[state.name];
      known.name = state.name;
      for (const auto& [joint, value] : state.values) {
        const auto [said, is_new] = known.values.emplace(joint, value);
        std::string& owner = owners[{state.name, joint}];
        if (is_new) owner = state.group;
        if (is_new && !is_own && own.contains(state.name)) known.aside.insert(joint);
        if (said->second != value && owner != group)
          known.doubts[joint] = "groups " + quote(owner) + " and " + quote(state.group) + " have joint " +
                                quote(joint) + " at " + short_text(said->second) + " and at " +
                                short_text(value) + ", expected one of them, or a state of " +
                                (group.empty() ? "a planning group" : "group " + quote(group));
      }
    }
  }
  std::vector<NamedState> result;
  for (auto& [name, state] : states) result.push_back(std::move(state));
  return result;
}

}  // namespace clearway
