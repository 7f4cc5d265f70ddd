#include "mapping/files/octree_file.hpp"

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <array>
#include <charconv>
#include <cmath>
#include <locale>
#include <optional>
#include <sstream>
#include <tuple>
#include <utility>

#include "mapping/files/map_file.hpp"
#include "mapping/files/octree_check.hpp"
#include "mapping/files/octree_reader.hpp"
#include "mapping/files/painted_csv.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

constexpr std::string_view threshold_comment = "# clearway occupied_log_odds ";
constexpr std::string_view clamping_comment = "# clearway clamped_log_odds ";
constexpr std::string_view integration_comment = "# clearway integration ";
constexpr std::string_view agreement_comment = "# clearway hits_called_free ";
constexpr std::string_view amid_free_comment = "# clearway hits_amid_free ";
constexpr std::string_view damage_comment = "# clearway damaged_recording records ";
constexpr std::string_view hand_edits_comment = "# clearway voxels_by_hand ";
constexpr std::string_view cut_comment = "# clearway voxels_cut ";
constexpr std::string_view painted_comment = "# clearway painted ";
constexpr std::string_view seen_comment = "# clearway seen_bytes ";

/// The rest of each header line that starts with `prefix`, one a line.
std::string comments(std::string_view header, std::string_view prefix) {
  std::string found;
  while (!header.empty()) {
    const auto end = header.find('\n');
    const std::string_view line = header.substr(0, end + 1);
    if (line.starts_with(prefix)) found += line.substr(prefix.size());
    header.remove_prefix(line.size());
  }
  return found;
}

void restore_threshold(FusedTree& tree, std::string_view header, const std::filesystem::path& file) {
  const std::string text = comments(header, threshold_comment);
  float log_odds = 0.0F;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), log_odds);
  if (end.ec != std::errc() || !std::isfinite(log_odds)) {
    throw DamagedFile("'" + file.string() + "' is damaged: its header lacks occupied_log_odds");
  }
  tree.set_occupied_log_odds(log_odds);
}

/// Two log-odds; of a tree with OctoMap's own nothing is said.
void restore_clamping(FusedTree& tree, std::string_view header, const std::filesystem::path& file) {
  const std::string text = comments(header, clamping_comment);
  if (text.empty()) return;
  float least = 0.0F, most = 0.0F;
  const char* const last = text.data() + text.size();
  const auto first = std::from_chars(text.data(), last, least);
  const bool has_second = first.ec == std::errc() && std::string_view(first.ptr, last).starts_with(" to ");
  const auto second = has_second ? std::from_chars(first.ptr + 4, last, most) : first;
  if (!has_second || second.ec != std::errc() || *second.ptr != '\n' || !std::isfinite(least) ||
      !std::isfinite(most) || !(least < most))
    throw DamagedFile("'" + file.string() + "' is damaged: its header does not say how evidence is clamped");
  tree.set_clamping_log_odds(least, most);
}

/// Files from before maps knew it do not say.
void restore_integration(FusedTree& tree, std::string_view header, const std::filesystem::path& file) {
  const std::string text = comments(header, integration_comment);
  if (text.empty()) return;
  using enum MapIntegration;
  for (const MapIntegration each : {none, safe, unknown, compatible}) {
    if (text != std::string(to_string(each)) + "\n") continue;
    tree.set_integration(each);
    return;
  }
  throw DamagedFile("'" + file.string() + "' is damaged: its header names no integration that is known");
}

void restore_damage(FusedTree& tree, std::string_view header, const std::filesystem::path& file) {
  const std::string text = comments(header, damage_comment);
  if (text.empty()) return;
  std::uint64_t records = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), records);
  if (end.ec != std::errc() || *end.ptr != '\n')
    throw DamagedFile("'" + file.string() +
                      "' is damaged: its header does not say how many records were read");
  tree.set_records_before_damage(records);
}

/// Two counts: voxels made occupied, and made free.
void restore_hand_edits(FusedTree& tree, std::string_view header, const std::filesystem::path& file) {
  const std::string text = comments(header, hand_edits_comment);
  if (text.empty()) return;
  HandEdits edits;
  const char* const last = text.data() + text.size();
  const auto first = std::from_chars(text.data(), last, edits.occupied);
  const bool has_second = first.ec == std::errc() && std::string_view(first.ptr, last).starts_with(" and ");
  const auto second = has_second ? std::from_chars(first.ptr + 5, last, edits.freed) : first;
  if (!has_second || second.ec != std::errc() || *second.ptr != '\n')
    throw DamagedFile("'" + file.string() +
                      "' is damaged: its header does not say how many voxels were changed by hand");
  tree.add_hand_edits(edits);
}

/// How many occupied voxels a crop cut off.
void restore_cut(FusedTree& tree, std::string_view header, const std::filesystem::path& file) {
  const std::string text = comments(header, cut_comment);
  if (text.empty()) return;
  HandEdits edits;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), edits.cut);
  if (end.ec != std::errc() || *end.ptr != '\n')
    throw DamagedFile("'" + file.string() +
                      "' is damaged: its header does not say how many voxels a crop cut off");
  tree.add_hand_edits(edits);
}

/// "12 of 3456" of a comment's line. Nothing: there is no such line.
std::optional<std::pair<std::uint64_t, std::uint64_t>> share_in(std::string_view header,
                                                                std::string_view comment,
                                                                const std::filesystem::path& file) {
  const std::string text = comments(header, comment);
  if (text.empty()) return std::nullopt;
  std::uint64_t part = 0, whole = 0;
  const char* const last = text.data() + text.size();
  const auto first = std::from_chars(text.data(), last, part);
  const bool has_second = first.ec == std::errc() && std::string_view(first.ptr, last).starts_with(" of ");
  const auto second = has_second ? std::from_chars(first.ptr + 4, last, whole) : first;
  if (!has_second || second.ec != std::errc() || *second.ptr != '\n' || part > whole)
    throw DamagedFile("'" + file.string() +
                      "' is damaged: its header does not say how many hits the map called free");
  return std::pair(part, whole);
}

void restore_agreement(FusedTree& tree, std::string_view header, const std::filesystem::path& file) {
  ScanAgreement agreement;
  if (const auto counts = share_in(header, agreement_comment, file))
    std::tie(agreement.called_free, agreement.looked_up) = *counts;
  if (const auto counts = share_in(header, amid_free_comment, file))
    std::tie(agreement.amid_free, agreement.compared) = *counts;
  tree.add_agreement(agreement);
}

/// What a map says of itself in a file of ours and in those for other programs: comment lines, none where
/// there is nothing to say.
std::string marks_of(const FusedTree& tree) {
  std::string marks;
  if (const auto records = tree.records_before_damage())
    marks += std::string(damage_comment) + std::to_string(*records) + "\n";
  const HandEdits& edits = tree.hand_edits();
  if (edits.occupied > 0 || edits.freed > 0)
    marks += std::string(hand_edits_comment) + std::to_string(edits.occupied) + " and " +
             std::to_string(edits.freed) + "\n";
  if (edits.cut > 0) marks += std::string(cut_comment) + std::to_string(edits.cut) + "\n";
  return marks;
}

void restore_marks(FusedTree& tree, std::string_view header, const std::filesystem::path& file) {
  restore_damage(tree, header, file);
  restore_hand_edits(tree, header, file);
  restore_cut(tree, header, file);
}

/// Of marks in files for other programs, which no seal of ours covers: else they would be read as ours.
constexpr std::string_view own_prefix = "# clearway ", exported_prefix = "# exported by clearway: ";

/// The header of a file for other programs, with the marks behind its first line.
std::string header_with_marks(const FusedTree& tree, std::string header) {
  std::istringstream marks(marks_of(tree));
  std::string exported;
  for (std::string line; std::getline(marks, line);)
    exported += std::string(exported_prefix) + line.substr(own_prefix.size()) + "\n";
  return header.insert(header.find('\n') + 1, exported);
}

/// The marks of such a header, as they are in files of ours.
std::string exported_marks(std::string_view header) {
  std::istringstream lines(comments(header, exported_prefix));
  std::string marks;
  for (std::string line; std::getline(lines, line);) marks += std::string(own_prefix) + line + "\n";
  return marks;
}

/// The shortest text that reads back to the same number.
std::string digits_of(float value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end.ptr};
}

}  // namespace

std::string format_fused_tree(const FusedTree& tree, const std::vector<PaintedVolume>& volumes,
                              const SeenStamps* seen) {
  // Stock programs compare log-odds with 0: below that they would free what blocks, and are given no name
  // they know.
  const bool stock_agrees = !(tree.getOccupancyThresLog() < 0.0F);
  const std::string header = octree_header(false, stock_agrees ? "ColorOcTree" : FusedTree::type_name,
                                           tree.size(), tree.getResolution());
  const auto first_line = header.find('\n') + 1;

  std::ostringstream rest;
  rest.imbue(std::locale::classic());  // a program's own may group digits
  if (stock_agrees) rest << fused_nodes_comment;
  rest << threshold_comment << digits_of(tree.getOccupancyThresLog()) << "\n";
  const FusedTree usual(1.0);
  const float least = tree.getClampingThresMinLog(), most = tree.getClampingThresMaxLog();
  if (least != usual.getClampingThresMinLog() || most != usual.getClampingThresMaxLog())
    rest << clamping_comment << digits_of(least) << " to " << digits_of(most) << "\n";
  rest << integration_comment << to_string(tree.integration()) << "\n";
  if (const ScanAgreement& agreement = tree.agreement(); agreement.looked_up > 0)
    rest << agreement_comment << agreement.called_free << " of " << agreement.looked_up << "\n";
  if (const ScanAgreement& agreement = tree.agreement(); agreement.compared > 0)
    rest << amid_free_comment << agreement.amid_free << " of " << agreement.compared << "\n";
  rest << marks_of(tree);
  std::istringstream painted(format_painted(volumes));
  for (std::string line; std::getline(painted, line);) rest << painted_comment << line << "\n";
  const std::string looks = seen == nullptr ? std::string() : format_seen(*seen);
  if (!looks.empty()) rest << seen_comment << looks.size() << "\n";
  rest << header.substr(first_line);
  tree.writeData(rest);
  rest << looks;

  const std::string before = header.substr(0, first_line);
  const std::string after = std::move(rest).str();
  return before + seal_line(before, after) + after;
}

std::size_t seen_bytes(const CheckedOctree& checked, std::size_t data, const std::filesystem::path& file) {
  const std::string text = comments(checked.header, seen_comment);
  if (text.empty() || !checked.fused) return 0;
  std::size_t size = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), size);
  if (end.ec != std::errc() || size > data)
    throw DamagedFile("'" + file.string() + "' is damaged: its header's seen_bytes are not there");
  return size;
}

std::vector<PaintedVolume> restore_header(FusedTree& tree, const CheckedOctree& checked,
                                          const std::filesystem::path& file) {
  tree.set_integration(MapIntegration::unknown);
  restore_marks(tree, checked.fused ? std::string(checked.header) : exported_marks(checked.header), file);
  if (!checked.fused) return {};
  restore_threshold(tree, checked.header, file);
  restore_clamping(tree, checked.header, file);
  restore_integration(tree, checked.header, file);
  restore_agreement(tree, checked.header, file);
  return parse_painted(comments(checked.header, painted_comment), file);
}

OctreeContent parse_octree(std::string_view bytes, const std::filesystem::path& file) {
  CheckedOctree checked = check_octree(bytes, file);
  const std::size_t looks = seen_bytes(checked, checked.data.size(), file);
  std::shared_ptr<const SeenStamps> seen;
  if (looks > 0) {
    seen = std::make_shared<const SeenStamps>(
        parse_seen(checked.data.substr(checked.data.size() - looks), file));
    checked.data.remove_suffix(looks);
  }
  const std::shared_ptr<FusedTree> tree = read_tree(checked, file);
  std::vector<PaintedVolume> volumes = restore_header(*tree, checked, file);
  return {tree, std::move(volumes), checked.fused, seen};
}

std::string format_color_tree(const FusedTree& tree) {
  MirrorTree<octomap::ColorOcTree> colored(tree.getResolution());
  const float threshold = tree.getOccupancyThresLog();
  colored.mirror(tree, [&](const FusedNode& from, octomap::ColorOcTreeNode& to) {
    to.setLogOdds(from.observed() ? from.getLogOdds() - threshold : tree.getClampingThresMinLog());
    switch (tree.state(from)) {
      case VoxelState::painted:
        to.setColor(60, 180, 75);
        break;
      case VoxelState::seen_free:
        to.setColor(90, 150, 230);
        break;
      case VoxelState::occupied:
        to.setColor(90, 90, 90);
        break;
      case VoxelState::conflict:
        to.setColor(220, 40, 40);
        break;
      case VoxelState::unknown:
        break;
    }
  });
  if (colored.getRoot() != nullptr) colored.updateInnerOccupancy();
  std::ostringstream stream;
  stream << header_with_marks(
      tree, octree_header(false, colored.getTreeType(), colored.size(), colored.getResolution()));
  colored.writeData(stream);
  return std::move(stream).str();
}

std::string format_binary_tree(const FusedTree& tree) {
  MirrorTree<octomap::OcTree> binary(tree.getResolution());
  binary.mirror(tree, [&](const FusedNode& from, octomap::OcTreeNode& to) {
    const VoxelState state = tree.state(from);
    const bool blocked = state == VoxelState::occupied || state == VoxelState::conflict;
    to.setLogOdds(blocked ? binary.getClampingThresMaxLog() : binary.getClampingThresMinLog());
  });
  binary.prune();
  std::ostringstream stream;
  stream << header_with_marks(
      tree, octree_header(true, binary.getTreeType(), binary.size(), binary.getResolution()));
  if (binary.getRoot() != nullptr) binary.writeBinaryNode(stream, binary.getRoot());
  return std::move(stream).str();
}

}  // namespace clearway
