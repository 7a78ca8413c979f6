-- The dossier of a part: its run, and the certificate of each thread and hole that was cut in it, in order.
--
--     SET VARIABLE machine = 'lathe1';
--     SET VARIABLE run = '0000a01f/12/345';     -- Run/Key
WITH
    run AS (
        FROM told('run') WHERE machine = getvariable('machine') AND run_key = getvariable('run')
    ),
    cut AS (
        FROM told('thread')
        WHERE machine = getvariable('machine') AND run_of(thread_key, thread_program) = getvariable('run')
    )
SELECT run.machine, run_key, run.at_utc AS ended, run_finished, run_setpoint_hash, run_late, run_largest_error_um,
       thread_key, thread_line, thread_kind, thread_end, thread_passes, thread_late, thread_largest_error_um,
       thread_rms_error_um, cut_known, cut_why, cut_lead_mm, cut_lead_error_um, cut_lead_error_um_u, cut_worst_um, cut_worst_um_u
FROM run
LEFT JOIN cut ON cut.store = run.store
ORDER BY run.store, cut.number;
