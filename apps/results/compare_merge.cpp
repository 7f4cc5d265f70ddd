#include "apps/results/compare_merge.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>

#include "apps/results/compare_files.hpp"
#include "apps/results/compare_worst.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

struct ShardRecords {
  fs::path folder;
  CompareRecords records;
};

std::string folder_name(const fs::path& folder) { return "'" + plain(folder.string()) + "'"; }

[[noreturn]] void refuse_merge(const std::string& what) {
  throw std::invalid_argument("compare merge: " + what);
}

std::string shard_name(int index, int count) {
  return "shard " + std::to_string(index) + "/" + std::to_string(count);
}

/// One for each index.
std::vector<ShardRecords> read_shards(const std::vector<fs::path>& folders) {
  if (folders.empty()) refuse_merge("expected the folders of all shards, got none");
  std::vector<ShardRecords> shards;
  for (const fs::path& folder : folders) {
    if (!fs::exists(folder / records_name))
      refuse_merge(folder_name(folder) + " has no " + records_name +
                   ": expected a folder of results of `clearway compare`");
    shards.push_back({folder, CompareRecords::read(folder / records_name)});
  }
  return shards;
}

void require_one_comparison(const std::vector<ShardRecords>& shards) {
  const CompareAsked& first = shards.front().records.asked();
  for (const ShardRecords& shard : shards) {
    const CompareAsked& asked = shard.records.asked();
    const std::string differs = difference(first, asked);
    if (!differs.empty())
      refuse_merge(folder_name(shards.front().folder) + " and " + folder_name(shard.folder) +
                   " are of different comparisons: " + differs);
    if (asked.shard.count != first.shard.count)
      refuse_merge(folder_name(shard.folder) + " is " + shard_name(asked.shard.index, asked.shard.count) +
                   ", expected one of " + std::to_string(first.shard.count) + " as " +
                   folder_name(shards.front().folder));
  }
}

/// Names every shard that is lost or doubled.
void require_each_shard_once(const std::vector<ShardRecords>& shards) {
  const int count = shards.front().records.asked().shard.count;
  std::vector<std::string> of(static_cast<std::size_t>(count) + 1);
  std::string doubled, lost;
  int missing = 0;
  for (const ShardRecords& shard : shards) {
    const int index = shard.records.asked().shard.index;
    std::string& before = of.at(static_cast<std::size_t>(index));
    if (!before.empty())
      doubled += "; " + shard_name(index, count) + " is given twice, as " + before + " and as " +
                 folder_name(shard.folder);
    before = folder_name(shard.folder);
  }
  for (int index = 1; index <= count; ++index) {
    constexpr int most_named = 20;
    if (!of[static_cast<std::size_t>(index)].empty()) continue;
    if (++missing <= most_named) lost += (lost.empty() ? "" : ", ") + std::to_string(index);
    if (missing == most_named + 1) lost += ", …";
  }
  if (missing > 0)
    lost = "; of " + std::to_string(count) + " shards " + std::to_string(missing) + " missing: " + lost;
  if (const std::string wrong = lost + doubled; !wrong.empty()) refuse_merge(wrong.substr(2));
}

/// Every problem of every stage has all its runs in the shard that it belongs to.
void require_whole(const std::vector<ShardRecords>& shards) {
  for (const ShardRecords& shard : shards) {
    for (const auto& [e, s] : shard.records.stages()) {
      const CompareRecords::Stage& stage = *shard.records.stage(e, s);
      for (std::size_t i = 0; i < stage.size(); ++i) {
        if (stage[i].is_finished || !is_in(shard.records.asked().shard, e, s, i)) continue;
        refuse_merge(folder_name(shard.folder) + " is not whole: problem '" + stage[i].found.name +
                     "' of experiment '" + shard.records.asked().results.experiments[e].setup.name +
                     "' has not all its runs (go on with --resume)");
      }
    }
  }
}

/// A map that the shard kept, below its folder, where older results name the folder, too; nothing for others.
std::optional<std::string> kept_map(const ShardRecords& shard, const std::string& map_file) {
  const fs::path name = fs::path("maps") / fs::path(map_file).filename();
  if (map_file.empty() || name.lexically_normal() != name || !map_file.ends_with(name.string()) ||
      !fs::exists(shard.folder / name))
    return {};
  return name.string();
}

void copy_new(const fs::path& from, const fs::path& to) {
  require_input(from, "compare merge: file");
  make_folder_of(to);
  fs::copy_file(from, to, fs::copy_options::skip_existing);
}

/// A plan names a kept map as the results do.
void copy_plan(const fs::path& from, const fs::path& to, const std::string& old_map,
               const std::string& new_map) {
  std::string text = read_input(from, "plan file", 64U << 20U);
  const std::string before = "\"file\": \"" + old_map + "\"";
  if (const std::size_t at = text.find(before); at != std::string::npos)
    text.replace(at, before.size(), "\"file\": \"" + new_map + "\"");
  make_folder_of(to);
  save_file(to, text);
}

void copy_files(const ShardRecords& shard, const CompareProblem& problem, const fs::path& folder) {
  const std::optional<std::string> map = kept_map(shard, problem.map_file);
  if (map) {
    const fs::path kept = fs::path("maps") / fs::path(problem.map_file).filename();
    for (const auto& file : fs::directory_iterator(shard.folder / kept))
      copy_new(file.path(), folder / kept / file.path().filename());
  }
  for (const CompareRun& run : problem.runs) {
    if (run.plan_file.empty()) continue;
    copy_plan(shard.folder / run.plan_file, folder / run.plan_file, problem.map_file,
              map.value_or(problem.map_file));
  }
  if (!problem.page.empty()) copy_new(shard.folder / problem.page, folder / problem.page);
}

/// A planner's worst run of all is the worst of its shard, which drew it, were it not for the bound.
void copy_worst_pages(const std::vector<ShardRecords>& shards, const CompareRecords& all,
                      const fs::path& folder) {
  for (std::size_t e = 0; e < all.asked().results.experiments.size(); ++e) {
    const CompareExperiment experiment = all.experiment(e);
    for (const WorstPage& page : worst_pages(experiment, SIZE_MAX)) {
      const fs::path name = worst_page_file(experiment, experiment.problems[page.problem], page.number);
      for (const ShardRecords& shard : shards)
        if (fs::exists(shard.folder / name)) copy_new(shard.folder / name, folder / name);
    }
  }
}

CompareAsked asked_whole(const std::vector<ShardRecords>& shards) {
  CompareAsked asked = shards.front().records.asked();
  asked.shard = {};
  asked.results.part.clear();
  std::set<std::string> hosts{asked.results.host};
  for (const ShardRecords& shard : shards) {
    const std::string& host = shard.records.asked().results.host;
    if (hosts.insert(host).second) asked.results.host += ", " + host;
    asked.results.date = std::min(asked.results.date, shard.records.asked().results.date);
  }
  return asked;
}

CompareRecords merge_all(const std::vector<ShardRecords>& shards) {
  CompareRecords all(asked_whole(shards));
  for (const ShardRecords& shard : shards) {
    for (const auto& [e, s] : shard.records.stages()) {
      const CompareRecords::Stage& stage = *shard.records.stage(e, s);
      if (all.stage(e, s) == nullptr) {
        std::vector<CompareProblem> problems;
        for (const CompareRecords::Problem& problem : stage) {
          problems.push_back(problem.found);
          problems.back().runs.clear();
          problems.back().page.clear();
          problems.back().map_file = kept_map(shard, problem.found.map_file).value_or(problem.found.map_file);
        }
        const auto& in_vain = shard.records.drawn_in_vain();
        const auto why = in_vain.find({e, s});
        all.open(e, s, std::move(problems), why == in_vain.end() ? "" : why->second);
      }
      if (all.stage(e, s)->size() != stage.size())
        refuse_merge(folder_name(shard.folder) + " has other problems than the other shards");
      for (std::size_t i = 0; i < stage.size(); ++i) {
        for (const CompareRun& run : stage[i].found.runs) all.add(e, s, i, run);
        if (stage[i].is_finished) all.finish(e, s, i, stage[i].found.page);
      }
    }
    all.add_time(shard.records.results(shard.folder, 0).time);
  }
  return all;
}

/// No problem fell between two shards.
void require_all(const CompareRecords& records) {
  for (const auto& [e, s] : records.stages())
    for (const CompareRecords::Problem& problem : *records.stage(e, s))
      if (!problem.is_finished)
        refuse_merge("no shard has problem '" + problem.found.name + "' of experiment '" +
                     records.asked().results.experiments[e].setup.name + "'");
}

std::vector<ShardRecords> checked_shards(const std::vector<fs::path>& folders) {
  std::vector<ShardRecords> shards = read_shards(folders);
  require_one_comparison(shards);
  require_each_shard_once(shards);
  require_whole(shards);
  return shards;
}

}  // namespace

CompareResults merge_into(const fs::path& folder, const std::vector<fs::path>& folders) {
  const std::vector<ShardRecords> shards = checked_shards(folders);
  for (const ShardRecords& shard : shards)
    for (const auto& [e, s] : shard.records.stages())
      for (const CompareRecords::Problem& problem : *shard.records.stage(e, s))
        if (problem.is_finished) copy_files(shard, problem.found, folder);
  const CompareRecords records = merge_all(shards);
  records.require_problems();
  require_all(records);
  copy_worst_pages(shards, records, folder);
  const CompareResults results = records.results(folder);
  save_results(results, folder);
  save_file(folder / records_name, records.text());
  return results;
}

}  // namespace clearway
