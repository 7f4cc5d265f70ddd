#include "apps/results/compare_files.hpp"
#include "mapping/system/atomic_file.hpp"

namespace clearway {

void save_results(const CompareResults& results, const std::filesystem::path& folder) {
  save_database(results, folder / result_files[0]);
  save_file(folder / result_files[1], to_csv(results));
  save_file(folder / result_files[2], to_ompl_log(results));
  save_file(folder / result_files[3], to_html(results));
}

}  // namespace clearway
