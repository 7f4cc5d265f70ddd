// What to_html (apps/results/compare_page.cpp) writes into the page.

/// As summary_json (apps/results/compare_summary.cpp) writes it.
export interface Planner {
  label: string; planner: string; options: Record<string, string>; certified: boolean;
  solved: number; valid: number; total: number;
  problems: number;                                         // that the runs are of
  valid_share_95: [number, number];                         // Wilson's interval of as many runs as these are worth
  cpu_median_s: number | null;                              // of solved runs; null: of teams
  search_cpu_mean_s: number | null; shortcut_cpu_mean_s: number | null; proof_cpu_mean_s: number | null;  // its parts; null: none of that
  space_cpu_mean_s: number | null; check_cpu_mean_s: number | null;  // before and after; null: of teams
  time_median_s: number | null; time_p95_s: number | null;  // of solved runs
  cost_median_joules: number | null; length_median_rad: number | null; steps_median: number | null;  // of valid runs
  unsolved: Record<string, number>;                         // by status
}

/// As overview_json (apps/results/compare_overview.cpp) writes it: a planner over all experiments of single robots.
export interface OverviewRow extends Planner {
  same_options: boolean;                    // in all experiments
  experiments: number;                      // in which it has runs
  comparable: boolean;                      // it has all the runs that any planner has
  shared: Planner;                          // of the runs that all comparable planners solved
}
export interface Overview { experiments: number; runs: number; shared_runs: number; length_unit: string; notes: string[]; planners: OverviewRow[] }

/// As sweeps_json (apps/results/compare_resolutions.cpp) writes it: experiments that differ in resolution alone.
export interface Sweep {
  experiments: string[]; resolutions_m: number[]; note: string;   // finest first
  planners: { label: string; points: Planner[] }[];               // a point for each resolution
}

export interface Run {
  planner: number; problem: number; run: number;
  status: string; check: string;
  time: number; cpu: number; cost: number | null;  // s, s, J; null: not known
  clearance: number | null;    // m, by the check
  page?: string;               // in 3D, of a worst case, beside the report
  id: string;                  // for --rerun
  explanation?: string;        // of a run that is not solved, or not valid
}

export interface Profile { planner: number; waypoints: number[][] }

/// As paired_planners (apps/results/compare_statistics.cpp) finds it: the first planner against the second.
export interface Figure { problems: number; ratio: number; p: number }
export interface Pair {
  first: number; second: number; firstMore: number; secondMore: number; successP: number;
  cpu: Figure; cost: Figure; words: string;
}

export interface Experiment {
  name: string; title: string; paper: string; notes: string; conditions: string;
  timeLimit: number | null;                 // s a leg; null: none
  joints: string[]; prismatic: boolean[]; plots: string[];
  planners: Planner[]; problems: string[]; runs: Run[]; profiles: Profile[];
  pairs: Pair[];                            // of single robots
  pages: { name: string; file: string; problem: number }[];  // animations, beside the page
  worst: { kind: string; run: number }[];   // the worst runs of each planner, by their index in `runs`
  table: string[][] | null;                 // of teams: a header, then a row for each planner
}

export type Meanings = Record<string, Record<string, string>>;   // of options, by planner

export interface Page { title: string; subtitle: string; about: string; overview: Overview | null; resolutions: Sweep[]; meanings: Meanings; experiments: Experiment[] }

export const isValid = (run: Run) => run.status === "solved" && run.check === "valid";

export function readPage(): Page {
  return JSON.parse(document.getElementById("page")!.textContent!) as Page;
}
