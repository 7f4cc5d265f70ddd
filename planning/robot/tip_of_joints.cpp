#include "planning/robot/tip_of_joints.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <tuple>

namespace clearway {
namespace {

bool holds(const std::string& text, std::string_view word) { return text.find(word) != std::string::npos; }

/// A name in small letters, by words: "LeftGripper_Tool0" is left, gripper, tool.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  bool was_small = false;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (!std::isalpha(letter) || (was_small && std::isupper(letter)))
      if (!words.back().empty()) words.emplace_back();
    if (std::isalpha(letter)) words.back() += static_cast<char>(std::tolower(letter));
    was_small = std::islower(letter) != 0;
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::string joined_words(const std::string& name) {
  std::string text;
  for (const std::string& word : words_of(name)) text += word;
  return text;
}

/// How much a link's name is that of a tool's frame; 0: not at all. What a gripper closes about is more than
/// what it is screwed on.
int rank_of_tool(const std::string& link) {
  const std::string text = joined_words(link);
  for (const char* point : {"grippercenter", "grippercentre", "gripperframe", "toolcenter", "toolcentre"})
    if (holds(text, point)) return 4;
  int rank = holds(text, "endeffector") ? 2 : 0;
  for (const std::string& word : words_of(link)) {
    if (word == "tcp" || word.starts_with("grasp")) rank = std::max(rank, 4);
    if (word == "tool") rank = std::max(rank, 3);
    if (word == "ee" || word == "eef") rank = std::max(rank, 2);
    if (word == "flange" || word == "faceplate") rank = std::max(rank, 1);
  }
  return rank;
}

bool is_camera(const std::string& link) {
  constexpr std::array<std::string_view, 9> words{"camera",    "optical", "lidar",  "laser",        "kinect",
                                                  "realsense", "imu",     "webcam", "accelerometer"};
  const std::vector<std::string> said = words_of(link);
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    return std::find(said.begin(), said.end(), word) != said.end();
  });
}

bool has_finger_word(const std::string& name) {
  const std::string text = joined_words(name);
  for (const char* word : {"finger", "jaw", "claw", "knuckle", "thumb"})
    if (holds(text, word)) return true;
  return false;
}

/// As a joint that opens a gripper, and turns or moves nothing else of the arm.
bool opens_gripper(const std::string& joint) {
  const std::vector<std::string> words = words_of(joint);
  return !words.empty() && std::all_of(words.begin(), words.end(), [](const std::string& word) {
    return word == "gripper" || word == "joint" || word == "left" || word == "right" || word == "drive";
  }) && std::find(words.begin(), words.end(), "gripper") != words.end();
}

constexpr double most_travel = 0.12;  ///< m, of a finger that slides

/// A robot's links, by the joints that move them.
class Arms {
 public:
  Arms(const Robot& free, const std::set<std::string>& arm, const Robot& robot)
      : free_(free),
        robot_(robot),
        arm_is_stated_(!arm.empty()),
        joint_(free.links.size(), -1),
        last_(joint_),
        depth_(joint_.size(), 0) {
    last_[0] = 0;
    for (std::size_t i = 1; i < joint_.size(); ++i) {
      const int joint = free.links[i].joint;
      const bool is_of_arm = joint >= 0 && (arm.empty() || arm.contains(name_of(joint)));
      if (is_of_arm) joint_[i] = joint;
      depth_[i] = depth_[parent(i)] + 1;
      last_[i] = is_of_arm ? static_cast<int>(i) : joint >= 0 ? 0 : last_[parent(i)];
    }
    below_.resize(joint_.size());
    carries_.resize(joint_.size());
    for (std::size_t i = 1; i < joint_.size(); ++i)
      if (joint_[i] >= 0) ++carries_[static_cast<std::size_t>(carrier(static_cast<int>(i)))];
    for (std::size_t i = 1; i < joint_.size(); ++i) below_[parent(i)].push_back(static_cast<int>(i));
    for (std::size_t i = 0; i < joint_.size(); ++i)
      from_.push_back(joint_[i] < 0 ? std::set<int>() : joints_from(static_cast<int>(i)));
    for (std::size_t i = 0; i < joint_.size(); ++i) fingers_.push_back(is_finger(static_cast<int>(i)));
  }

  TipOfJoints tip() const {
    TipOfJoints result;
    const std::vector<int> hands = hands_of_arms();
    if (hands.empty()) return result;
    int best = hands.front();
    for (const int hand : hands)
      if (moving(joints_above(hand)) > moving(joints_above(best))) best = hand;
    result.link = end_of(best);
    if (const int deepest = deepest_link(); !arm_is_stated_ && !is_sure(result.link, best, deepest))
      return end_of_longest_branch(deepest);
    for (const int hand : hands)
      if (hand != best && is_rival(hand, best)) result.others.push_back(end_of(hand));
    for (std::size_t i = 1; i < joint_.size(); ++i)
      if (joint_[i] >= 0 && carrier(static_cast<int>(i)) == best && is_doubtful_finger(static_cast<int>(i)))
        result.finger_joint = free_.links[i].joint_name;
    return result;
  }

 private:
  /// The first of the links with the most links above.
  int deepest_link() const {
    return static_cast<int>(std::max_element(depth_.begin(), depth_.end()) - depth_.begin());
  }

  /// Whether what is beyond `end` on the longest branch is a gripper, a camera, or held, and no part of the
  /// arm, by its names or by its form. Branches alone do not say so: rods of parallelograms, counterweights,
  /// wheels and the heads of gantries branch as well.
  bool is_sure(int end, int hand, int deepest) const {
    if (end == deepest || depth_[static_cast<std::size_t>(end)] == depth_[static_cast<std::size_t>(deepest)])
      return true;
    if (rank_of_tool(link(deepest).name) > 2) return false;
    const int last = last_[static_cast<std::size_t>(deepest)];
    if (!is_on(deepest, hand)) return !moves_apart(deepest, hand);
    for (int at = last; at != hand; at = carrier(at))
      if (at <= 0 || !is_of_gripper(at)) return false;
    return last != hand || hangs_on_camera(deepest, hand) || has_tie(deepest, hand);
  }

  bool is_on(int link_index, int above) const {
    while (link_index > above) link_index = link(link_index).parent;
    return link_index == above;
  }

  /// Whether a joint that is not held moves a link and not another one.
  bool moves_apart(int one, int other) const {
    std::set<int> own = joints_above(one);
    for (const int joint : joints_above(other)) own.erase(joint);
    return moving(own) > 0;
  }

  /// Whether names, a twin, or a tool's frame beside it say that a moved link is of a gripper.
  bool is_of_gripper(int moved) const {
    const Link& finger = link(moved);
    return has_finger_word(finger.name) || has_finger_word(finger.joint_name) ||
           opens_gripper(finger.joint_name) || has_twin(moved) ||
           (is_last(moved) && is_beside_tool_frame(moved));
  }

  /// Whether it slides little, and another link on the same one as far.
  bool has_twin(int moved) const {
    const double travel = travel_of(moved);
    if (travel > most_travel) return false;
    for (int other = 1; other < static_cast<int>(last_.size()); ++other)
      if (other != moved && joint(other) >= 0 && carrier(other) == carrier(moved) &&
          std::abs(travel_of(other) - travel) <= 0.01 * travel)
        return true;
    return false;
  }

  /// How far a moved link slides, m; infinite for one that turns.
  double travel_of(int moved) const {
    if (kind_of(free_, link(moved)) != JointKind::prismatic) return std::numeric_limits<double>::infinity();
    const Joint& slide = free_.joints[static_cast<std::size_t>(link(moved).joint)];
    return (slide.upper - slide.lower) * std::abs(link(moved).multiplier);
  }

  /// Whether a link named as a camera or a finger is between a frame, included, and the hand that carries it.
  bool hangs_on_camera(int frame, int hand) const {
    for (int at = frame; at != hand; at = link(at).parent)
      if (is_beside_tool(link(at).name)) return true;
    return false;
  }

  /// Whether a hand carries another frame as deep, so that the first of them would be no more the tip.
  bool has_tie(int deepest, int hand) const {
    const int depth = depth_[static_cast<std::size_t>(deepest)];
    for (std::size_t i = static_cast<std::size_t>(deepest) + 1; i < depth_.size(); ++i)
      if (depth_[i] == depth && last_[i] == hand) return true;
    return false;
  }

  /// The tip where nothing is sure; others that are as deep and have joints of their own as an arm has.
  TipOfJoints end_of_longest_branch(int deepest) const {
    TipOfJoints result;
    result.link = deepest;
    for (int i = deepest + 1; i < static_cast<int>(depth_.size()); ++i)
      if (depth_[static_cast<std::size_t>(i)] == depth_[static_cast<std::size_t>(deepest)] &&
          is_rival(i, deepest))
        result.others.push_back(i);
    return result;
  }

  const std::string& name_of(int joint) const { return free_.joints[static_cast<std::size_t>(joint)].name; }
  const Link& link(int index) const { return free_.links[static_cast<std::size_t>(index)]; }
  std::size_t parent(std::size_t link) const { return static_cast<std::size_t>(free_.links[link].parent); }
  int joint(int link) const { return joint_[static_cast<std::size_t>(link)]; }

  /// The link that the last joint above a moved one moves; 0: none, or one that is not of the arm is between.
  int carrier(int moved) const { return last_[parent(static_cast<std::size_t>(moved))]; }

  /// The link and all that hang on it.
  std::vector<int> links_from(int first) const {
    std::vector<int> links{first};
    for (std::size_t at = 0; at < links.size(); ++at)
      for (const int next : below_[static_cast<std::size_t>(links[at])]) links.push_back(next);
    return links;
  }

  /// The joints that move a link against the root, each once where others mimic it.
  std::set<int> joints_above(int moved) const {
    std::set<int> joints;
    for (int at = moved; at > 0; at = link(at).parent)
      if (joint(at) >= 0) joints.insert(joint(at));
    return joints;
  }

  /// The joints that move a link and what hangs on it against what carries it, and not the carrier, too.
  std::set<int> joints_from(int moved) const {
    std::set<int> joints;
    for (const int at : links_from(moved))
      if (joint(at) >= 0) joints.insert(joint(at));
    for (const int above : joints_above(link(moved).parent)) joints.erase(above);
    return joints;
  }

  /// How many of these joints move: held ones do not.
  std::size_t moving(const std::set<int>& joints) const {
    return static_cast<std::size_t>(std::count_if(joints.begin(), joints.end(), [&](int one) {
      return std::any_of(robot_.joints.begin(), robot_.joints.end(),
                         [&](const Joint& joint) { return joint.name == name_of(one); });
    }));
  }

  /// The hands of what no other moved link hangs on, each once, in the order of the links.
  std::vector<int> hands_of_arms() const {
    std::vector<int> hands;
    for (std::size_t i = 1; i < joint_.size(); ++i) {
      if (joint_[i] < 0 || carries_[i] > 0) continue;
      const int hand = hand_of(static_cast<int>(i));
      if (std::find(hands.begin(), hands.end(), hand) == hands.end()) hands.push_back(hand);
    }
    return hands;
  }

  /// The highest link above a moved one that carries fingers; that one itself where none does.
  int hand_of(int moved) const {
    int hand = is_single_finger(moved) ? carrier(moved) : moved;
    for (int at = moved; carrier(at) > 0; at = carrier(at))
      if (fingers_[static_cast<std::size_t>(at)]) hand = carrier(at);
    return hand;
  }

  /// Whether a moved link begins one of several fingers: a short branch with few joints, beside which another
  /// has at least half as many. One that only mimics joints of the other mimics all of them: a rod of a
  /// parallelogram mimics some.
  bool is_finger(int moved) const {
    if (joint(moved) < 0) return false;
    constexpr std::size_t most_joints = 5;  // a thumb has; arms that part at a torso have more
    constexpr double longest = 0.35;        // m, of a finger of several joints
    const std::set<int>& joints = from_[static_cast<std::size_t>(moved)];
    for (int other = 1; other < static_cast<int>(last_.size()); ++other) {
      if (other == moved || joint(other) < 0 || carrier(other) != carrier(moved)) continue;
      const std::set<int>& others = from_[static_cast<std::size_t>(other)];
      const bool is_mimic = includes(joints, others) || includes(others, joints);
      if (is_mimic ? others == joints : 2 * others.size() >= joints.size())
        return joints.size() <= most_joints && (joints.size() < 3 || length_from(moved) <= longest);
    }
    return false;
  }

  static bool includes(const std::set<int>& all, const std::set<int>& some) {
    return std::includes(all.begin(), all.end(), some.begin(), some.end());
  }

  /// How far the last frame of a branch is from its first one at most.
  double length_from(int moved) const {
    double longest = 0.0;
    for (const int end : links_from(moved)) {
      double length = 0.0;
      for (int at = end; at != moved; at = link(at).parent)
        length += link(at).parent_from_link.translation().norm();
      longest = std::max(longest, length);
    }
    return longest;
  }

  /// Whether nothing but its own joint, and what mimics that, moves a link and what hangs on it.
  bool is_last(int moved) const {
    return carrier(moved) > 0 && from_[static_cast<std::size_t>(moved)].size() == 1 &&
           carries_[static_cast<std::size_t>(moved)] == 0;
  }

  /// Whether the last joint of an arm is that of a gripper of which no other finger moves.
  bool is_single_finger(int moved) const {
    return is_last(moved) && (looks_like_finger(moved) || is_only_slide(moved));
  }

  bool is_doubtful_finger(int moved) const {
    return is_last(moved) && is_only_slide(moved) && !fingers_[static_cast<std::size_t>(moved)] &&
           !looks_like_finger(moved);
  }

  bool looks_like_finger(int moved) const {
    const Link &last = link(moved), &hand = link(carrier(moved));
    const bool is_named = has_finger_word(last.name) || has_finger_word(last.joint_name);
    const bool is_prefix = has_finger_word(hand.name) || has_finger_word(hand.joint_name);
    return (is_named && !is_prefix) || opens_gripper(last.joint_name) || is_beside_tool_frame(moved);
  }

  /// Whether it is a short slide behind five other joints, which alone makes it one of a gripper.
  bool is_only_slide(int moved) const {
    return travel_of(moved) <= most_travel && joints_above(carrier(moved)).size() >= 5;
  }

  /// Whether what carries the link carries a tool's frame beside it: more than a flange, which a wrist may
  /// have as well.
  bool is_beside_tool_frame(int moved) const {
    const std::vector<int> carried = carried_by(carrier(moved));
    return std::any_of(carried.begin() + 1, carried.end(), [&](int frame) {
      const std::vector<int> below = links_from(frame);
      return rank_of_tool(link(frame).name) > 1 &&
             std::find(below.begin(), below.end(), moved) == below.end();
    });
  }

  /// Whether the other arm has about as many joints of its own, and not the best one's.
  bool is_rival(int hand, int best) const {
    const std::set<int> all = joints_above(hand), of_best = joints_above(best);
    std::set<int> own, own_of_best;
    std::set_difference(all.begin(), all.end(), of_best.begin(), of_best.end(),
                        std::inserter(own, own.end()));
    std::set_difference(of_best.begin(), of_best.end(), all.begin(), all.end(),
                        std::inserter(own_of_best, own_of_best.end()));
    constexpr std::size_t fewest = 3;  // a steered wheel has two, a head of a gantry one
    return moving(own) >= fewest && 3 * moving(own) >= 2 * moving(own_of_best);
  }

  /// What a moved link carries along, itself first, without cameras and what hangs on them.
  std::vector<int> carried_by(int hand) const {
    std::vector<int> carried{hand};
    for (std::size_t at = 0; at < carried.size(); ++at)
      for (const int next : below_[static_cast<std::size_t>(carried[at])])
        if (last_[static_cast<std::size_t>(next)] == hand && !is_camera(link(next).name))
          carried.push_back(next);
    return carried;
  }

  /// The last frame of a tool that a hand carries, else the last link; of several the one that they hang on.
  int end_of(int hand) const {
    int end = hand, rank = 0, depth = depth_[static_cast<std::size_t>(hand)];
    for (const int at : carried_by(hand)) {
      if (at == hand || has_finger_word(link(at).name)) continue;
      const int own_rank = rank_of_tool(link(at).name), own_depth = depth_[static_cast<std::size_t>(at)];
      const auto own = std::tuple(own_rank > 0, own_depth, own_rank),
                 best = std::tuple(rank > 0, depth, rank);
      if (own > best) end = at, rank = own_rank, depth = own_depth;
      if (own == best) end = common(at, end);
    }
    return end;
  }

  int common(int a, int b) const {
    while (a != b) (a > b ? a : b) = link(std::max(a, b)).parent;
    return a;
  }

  const Robot& free_;
  const Robot& robot_;
  bool arm_is_stated_;
  std::vector<int> joint_;  ///< of the arm, that moves each link against its parent; -1: none
  std::vector<int> last_;   ///< the link that the last joint above moves; 0: none, or one not of the arm
  std::vector<int> depth_;
  std::vector<int> carries_;  ///< moved links of which it is the carrier
  std::vector<std::vector<int>> below_;
  std::vector<std::set<int>> from_;  ///< joints_from of moved links
  std::vector<bool> fingers_;        ///< is_finger
};

}  // namespace

TipOfJoints tip_of_joints(const Robot& free, const std::set<std::string>& arm, const Robot& robot) {
  return Arms(free, arm, robot).tip();
}

bool is_beside_tool(const std::string& link) { return is_camera(link) || has_finger_word(link); }

bool is_tool_frame(const std::string& link) { return rank_of_tool(link) > 0; }

}  // namespace clearway
