#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/commands.hpp"
#include "apps/console/table.hpp"
#include "apps/print/tag_boards.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/atomic_folder.hpp"

namespace clearway {
namespace {

bool is_printed(const std::filesystem::path& relative) {
  const std::string name = relative.string();
  if (name == "setup.yaml") return true;
  for (const char* sheet : {"base", "probe", "gripper", "calibration"})
    if (name == std::string(sheet) + ".svg" || name == std::string(sheet) + ".pdf") return true;
  return false;
}

}  // namespace

int run_tags_print(const TagsPrintOptions& options, Console& console) {
  const TagBoards boards = lay_out_boards({options.base_tag, options.probe_tag, options.ball_radius,
                                           options.stem, options.gripper_tag, options.square});
  AtomicFolder folder(options.out, is_printed);
  std::vector<std::string> files;
  const auto save = [&](const std::string& name, const std::string& content) {
    save_file(folder.path() / name, content);
    files.push_back((options.out / name).string());
  };
  for (const Sheet& sheet : boards.sheets) {
    save(sheet.name + ".svg", to_svg(sheet));
    save(sheet.name + ".pdf", to_pdf(sheet));
  }
  save("setup.yaml", boards.setup);
  folder.publish();
  if (console.json) {
    console.out() << nlohmann::ordered_json{{"files", files}}.dump(2) << '\n';
    return exit_done;
  }
  std::vector<std::pair<std::string, std::string>> rows;
  for (const std::string& file : files) rows.emplace_back(rows.empty() ? "files" : "", file);
  print_rows(console.out(), rows);
  return exit_done;
}

}  // namespace clearway
