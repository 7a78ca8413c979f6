-- Time in each state, by machine: `off` where the board did not answer. What a machine does now counts to its last record.
WITH
    moments AS (
        SELECT machine, shop, node, store, number, at_utc, machine_state AS state FROM told('state')
        UNION ALL
        SELECT machine, shop, node, store, number, at_utc, CASE WHEN board_alive THEN 'found' ELSE 'off' END
        FROM told('presence')
    ),
    spans AS (
        SELECT machine, state,
               -- The numbers are in order, also where the clock was set back.
               greatest(lead(at_utc) OVER (PARTITION BY machine, shop, node, store ORDER BY number) - at_utc, INTERVAL 0 SECOND) AS span
        FROM moments
    )
SELECT machine, state, sum(epoch(span)) AS seconds,
       100 * sum(epoch(span)) / nullif(sum(sum(epoch(span))) OVER (PARTITION BY machine), 0) AS percent
FROM spans WHERE span IS NOT NULL
GROUP BY machine, state
ORDER BY machine, seconds DESC, state;
