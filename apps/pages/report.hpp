#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "apps/fusion/fusion.hpp"
#include "apps/pages/report_page.hpp"
#include "mapping/history/provenance.hpp"
#include "mapping/snapshot.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A plan of a replay, with what is needed to show it again.
struct ReplayPlan {
  std::string query;
  Plan plan;
  Configuration start;
  std::filesystem::path file;  ///< plans/*.json, relative to the output folder
  const ConfigurationSpace* space = nullptr;
  std::string approval{};  ///< of a taught plan: what became of it, in words; of others empty
};

/// Everything a replay produced; report.json and report.html are two views of it.
struct ReplayReport {
  std::filesystem::path recording;
  const Fusion* fusion = nullptr;
  Snapshot map;
  Provenance provenance;
  std::vector<ReplayPlan> plans;
  std::string planning_problem;         ///< why queries could not be asked at all; empty when they could
  std::string teaching{};               ///< JSON of what a person did; empty: nobody taught
  std::vector<PagePicture> pictures{};  ///< of the session
  std::vector<std::pair<std::string, double>> timings;  ///< stage, seconds
};

/// The report of a fusion, which has to live on: its timings by stage, but for what follows the fusion.
ReplayReport report_of(const Fusion& fusion, const std::filesystem::path& recording);

/// Saves the report's map in the folder and, beside it, what the fusion knows of each voxel's history, which
/// the report then has, too.
void save_fused_map(ReplayReport& report, const std::filesystem::path& folder);

/// Writes report.json, which it returns, and report.html.
std::string save_report(const ReplayReport& report, const std::filesystem::path& folder);

/// report.json (keys fixed by the design page).
std::string report_json(const ReplayReport& report);

/// report.html, self-contained.
std::string report_html(const ReplayReport& report, const std::string& json);

/// Name and text of each figure that the terminal and the page show.
std::vector<std::pair<std::string, std::string>> report_figures(const ReplayReport& report);

/// One row per plan for the terminal: query, planner, status, steps, joules, time, clearance.
std::vector<std::vector<std::string>> plan_table(const ReplayReport& report);

}  // namespace clearway
