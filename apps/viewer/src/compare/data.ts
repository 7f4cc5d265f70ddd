// What to_html (apps/compare/compare_page.cpp) writes into the page.

/// As summary_json (apps/compare/compare_summary.cpp) writes it.
export interface Planner {
  label: string; planner: string; options: Record<string, string>; certified: boolean;
  solved: number; valid: number; total: number;
  time_median_s: number | null; time_p95_s: number | null;  // of solved runs
  cost_median_joules: number | null; length_median_rad: number | null; steps_median: number | null;  // of valid runs
  unsolved: Record<string, number>;                         // by status
}

export interface Run {
  planner: number; problem: number; run: number;
  status: string; check: string;
  time: number; cost: number;  // s, J
  explanation?: string;        // of a run that is not solved, or not valid
}

export interface Profile { planner: number; waypoints: number[][] }

export interface Experiment {
  name: string; title: string; paper: string; notes: string; conditions: string;
  timeLimit: number | null;                 // s a leg; null: none
  joints: string[]; prismatic: boolean[]; plots: string[];
  planners: Planner[]; problems: string[]; runs: Run[]; profiles: Profile[];
  pages: { name: string; file: string }[];  // animations, beside the page
  table: string[][] | null;                 // of teams: a header, then a row for each planner
}

export interface Page { title: string; subtitle: string; about: string; experiments: Experiment[] }

export const isValid = (run: Run) => run.status === "solved" && run.check === "valid";

export function readPage(): Page {
  return JSON.parse(document.getElementById("page")!.textContent!) as Page;
}
