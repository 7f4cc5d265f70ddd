-- Success and time on the problems that `rrtconnect` solves, of what `clearway compare` measured:
--   sqlite3 -box OUT/results.sqlite < datasets/suites/local.sql
-- `valid`: solved, and the path holds before the independent check; `median_ms` is over all these problems,
-- an unsolved one counting as longer than any solved one (empty: the median one is unsolved).

CREATE TEMP VIEW reference AS SELECT problem, run FROM runs WHERE label = 'rrtconnect' AND valid;
CREATE TEMP VIEW judged AS
  SELECT runs.*, experiments.name AS experiment,
         substr(experiments.name, instr(experiments.name, '_') + 1) AS robot,
         substr(experiments.name, 1, instr(experiments.name || '_', '_') - 1) AS kind
  FROM runs JOIN reference USING (problem, run) JOIN problems ON problems.id = runs.problem
  JOIN experiments ON experiments.id = problems.experiment;

-- 1. All of them.
WITH ranked AS (
  SELECT *, row_number() OVER (PARTITION BY label ORDER BY NOT solved, time_s) AS place,
         count(*) OVER (PARTITION BY label) AS total FROM judged)
SELECT label, total AS of_rrtconnect, sum(solved) AS solved, sum(valid) AS valid,
       round(100.0 * sum(valid) / total, 1) AS percent,
       round(100.0 * sum(valid) / max(sum(solved), 1), 1) AS valid_of_solved_percent,
       round(max(CASE WHEN place = (total + 1) / 2 AND solved THEN 1000 * time_s END), 2) AS median_ms
FROM ranked GROUP BY label ORDER BY min(id);

-- 2. Per kind of scene and robot.
WITH ranked AS (
  SELECT *, row_number() OVER (PARTITION BY experiment, label ORDER BY NOT solved, time_s) AS place,
         count(*) OVER (PARTITION BY experiment, label) AS total FROM judged)
SELECT kind, robot, label, sum(valid) || ' / ' || total AS valid,
       round(max(CASE WHEN place = (total + 1) / 2 AND solved THEN 1000 * time_s END), 2) AS median_ms
FROM ranked GROUP BY experiment, label ORDER BY min(id);

-- 3. Which stage of boundary_plus solved how many.
SELECT CASE
         WHEN NOT solved THEN 'unsolved'
         WHEN explanation LIKE '%by the local method after a hand-over%' THEN 'hand-over, then the local method'
         WHEN explanation LIKE '%by a hand-over%' THEN 'hand-over'
         WHEN explanation LIKE '%by boundary following, plane %'
           THEN 'plane ' || substr(explanation, instr(explanation, 'plane ') + 6,
                                   instr(explanation, ')') - instr(explanation, 'plane ') - 5)
         WHEN explanation LIKE '%by the local method%' THEN 'local method'
         ELSE 'straight edge' END AS solved_by,
       count(*) AS problems
FROM runs WHERE planner = 'boundary_plus' GROUP BY label, solved_by ORDER BY problems DESC;
