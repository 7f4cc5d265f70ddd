// What to_html (apps/compare_page.cpp) writes into the page.

export interface Planner {
  label: string; planner: string; options: Record<string, string>; certified: boolean;
  solved: number; valid: number; total: number;
  median: number | null; p95: number | null;                     // s, of solved runs
  cost: number | null; length: number | null; steps: number | null;  // medians of valid runs: J, rad, edges
  unsolved: string;
}

export interface Run {
  planner: number; problem: number; run: number;
  status: string; check: string;
  time: number; cost: number;  // s, J
  explanation?: string;        // of a run that is not solved, or not valid
}

export interface Profile { planner: number; waypoints: number[][] }

export interface Experiment {
  name: string; title: string; paper: string; notes: string; conditions: string; timeLimit: number;  // s a leg
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
