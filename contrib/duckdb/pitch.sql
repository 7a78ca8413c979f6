-- Error of the pitch by machine, tool and month: how many threads, for how many it is known, the mean and the largest error
-- in a turn with the uncertainty of that one (of several the largest), and the largest error of the cut (all µm).
WITH
    cut AS (
        SELECT machine, store, start, thread_program AS program, thread_line, date_trunc('month', at_utc) AS month,
               abs(cut_lead_error_um) AS error, cut_lead_error_um_u AS u, abs(cut_worst_um) AS worst
        FROM told('thread') WHERE thread_kind = 'thread'
    ),
    -- A program may run again under its key.
    made AS (
        SELECT DISTINCT machine, store, start, run_program AS program, run_setpoint_hash
        FROM told('run') WHERE run_setpoint_hash IN (SELECT setpoint_hash FROM tools)
    )
SELECT machine, tool, month, count(*) AS threads, count(error) AS known, avg(error) AS mean_um,
       max(error) AS largest_um, arg_max(u, CASE WHEN error IS NOT NULL THEN (error, u) END) AS largest_um_u,
       max(worst) AS worst_um
FROM cut
LEFT JOIN made USING (machine, store, start, program)
LEFT JOIN tools ON setpoint_hash = run_setpoint_hash AND line = thread_line
GROUP BY ALL
ORDER BY ALL;
