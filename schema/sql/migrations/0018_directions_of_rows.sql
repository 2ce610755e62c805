-- Version 18: viewpoint_direction has the viewpoints that have signatures, and no others, so that a nearest query in a
-- sweep that is under way, or in a shard, does not walk through all that are still empty. No part of digests.

DELETE FROM viewpoint_direction
WHERE NOT EXISTS (SELECT 1 FROM signature s WHERE s.viewpoint_id = viewpoint_direction.viewpoint_id);
