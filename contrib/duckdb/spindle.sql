-- Drift of a spindle: how well the axes followed it, by machine and month, and by how many µm the error grows in a month
-- over all that is known of the machine, where that is a month at least. A machine whose error grows is to be looked at: encoder, belt, bearing, drive.
WITH
    cut AS (
        SELECT machine, at_utc, date_trunc('month', at_utc) AS month, thread_rms_error_um AS rms, abs(thread_largest_error_um) AS largest
        FROM told('thread') WHERE thread_measured > 0
    ),
    growth AS (
        SELECT machine, CASE WHEN max(at_utc) - min(at_utc) >= INTERVAL 30 DAY
               THEN regr_slope(rms, epoch(at_utc)) * 30 * 86400 END AS um_each_month
        FROM cut GROUP BY machine
    )
SELECT machine, month, count(*) AS threads, median(rms) AS rms_um, max(largest) AS largest_um, any_value(um_each_month) AS um_each_month
FROM cut JOIN growth USING (machine)
GROUP BY machine, month
ORDER BY um_each_month DESC NULLS LAST, machine, month;
