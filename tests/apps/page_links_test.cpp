// Links between the pages of the repository. That those of installed pages hold, too, is tested where they
// are installed (package/installed.cmake).
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "tests/apps/outputs_page.hpp"

namespace clearway {
namespace page_links_test {

namespace fs = std::filesystem;

/// All pages but those of builds and of what others wrote.
std::vector<fs::path> pages() {
  const std::set<std::string> not_ours = {"build", "out", "shared", "node_modules", "results"};
  std::vector<fs::path> found;
  const fs::path root = CLEARWAY_SOURCE_DIR;
  for (auto entry = fs::recursive_directory_iterator(root); entry != fs::recursive_directory_iterator();
       ++entry) {
    const std::string name = entry->path().filename();
    const bool is_top = entry.depth() == 0;
    if (entry->is_directory() &&
        (name.starts_with('.') || name == "node_modules" || (is_top && not_ours.contains(name))))
      entry.disable_recursion_pending();
    else if (name.ends_with(".md"))
      found.push_back(entry->path());
  }
  return found;
}

/// Without code, in which brackets are no links.
std::string prose_of(const fs::path& page) {
  return std::regex_replace(read_file(page), std::regex("```[^`]*```|`[^`\n]*`"), "x");
}

/// The places that a page's titles can be linked by.
std::set<std::string> anchors_of(const fs::path& page) {
  std::set<std::string> anchors;
  std::istringstream lines(read_file(page));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with('#'))
      anchors.insert(OutputsPage::anchor_of(line.substr(line.find_first_not_of("# "))));
  return anchors;
}

TEST(PageLinks, LeadToFilesAndTitlesThatAreThere) {
  const std::regex link(R"(\]\(([^)#: ]*)(#[^) ]*)?\))");
  std::size_t count = 0;
  for (const fs::path& page : pages()) {
    const std::string text = prose_of(page);
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) {
      const std::string file = (*at)[1], place = (*at)[2];
      const fs::path target = file.empty() ? page : page.parent_path() / file;
      ++count;
      EXPECT_TRUE(fs::exists(target)) << page << " links to " << file;
      if (!place.empty() && target.extension() == ".md") {
        EXPECT_TRUE(anchors_of(target).contains(place.substr(1))) << page << " links to " << file << place;
      }
    }
  }
  EXPECT_GT(count, 150U);
}

}  // namespace page_links_test
}  // namespace clearway
