"""Where each block (group, tile, first sample) stands in a file, and the rules its index entry must keep (step 9)."""
import numpy as np

from . import record_layout as layout


class BlockTable:
    """rows: the DATA records in file order; complete: every block of every group is present.

    `groups` lists (scope, dtype, channel count). Nothing here grows with the declared image, only with the index.
    """

    def __init__(self, records, geometry, groups):
        self._records, self._geometry, self._groups = records, geometry, groups
        self.rows = np.flatnonzero(records.names == b"DATA")
        self._check_entries()
        self._sort()
        for wrong, what in (
                (len(self.rows) != int(records.foot["data_record_count"]),
                 f"footer counts {records.foot['data_record_count']} DATA records, the file has {len(self.rows)}"),
                (self.complete != bool(int(records.foot["flags"]) & layout.FLAG_COMPLETE),
                 "footer flag 0 does not say whether all blocks are present")):
            if wrong:
                raise records.error("damaged", f"{what} (byte {records.bytes - 64})")

    def find(self, group, tile, begin):
        """Row of a block in the index, or None."""
        if not (0 <= group < len(self._groups) and 0 <= tile < 1 << 31 and 0 <= begin < 1 << 17):
            return None
        key = np.uint64(group << 48 | tile << 17 | begin)
        at = int(np.searchsorted(self._keys, key))
        return int(self._key_rows[at]) if at < len(self._keys) and self._keys[at] == key else None

    def _check_entries(self):
        geometry, entries = self._geometry, self._records.entries[self.rows]

        def refuse(bad, what):
            for at in np.flatnonzero(bad):
                entry = entries[at]
                raise self._records.error("damaged", f"{what} (record {self.rows[at]}: group {entry['group']}, "
                                                     f"tile {entry['tile']}, sample {entry['sample_begin']})")

        def by_group(function):
            return np.array([function(*group) for group in self._groups], np.int64)[entries["group"]]

        refuse(entries["group"] >= geometry.group_count, f"only {geometry.group_count} groups exist")
        tile, begin = entries["tile"].astype(np.int64), entries["sample_begin"].astype(np.int64)
        refuse(tile >= by_group(lambda scope, *_: geometry.tile_count(scope)), "tile outside the image")
        refuse((begin % geometry.block_spp != 0) | (begin >= by_group(lambda scope, *_: geometry.sample_count(scope))),
               "no block starts at this sample")
        is_pass = by_group(lambda scope, *_: scope == "pass") != 0
        is_pixel = by_group(lambda scope, *_: scope == "pixel") != 0
        y, x = np.divmod(tile, geometry.tiles_x)
        size = geometry.tile_size
        width = np.where(is_pass, 1, np.minimum(size, geometry.width - x * size))
        height = np.where(is_pass, 1, np.minimum(size, geometry.height - y * size))
        samples = np.where(is_pixel, 1, np.minimum(geometry.block_spp, geometry.spp - begin))
        refuse(entries["sample_count"] != samples, "sample_count does not follow from the geometry")
        raw = width * height * samples * by_group(lambda _, dtype, channels: dtype.itemsize * channels)
        refuse(entries["raw_bytes"] != raw.astype(np.uint64), "raw_bytes does not follow from the geometry")

    def _sort(self):
        entries = self._records.entries[self.rows]
        keys = (entries["group"].astype(np.uint64) << np.uint64(48)
                | entries["tile"].astype(np.uint64) << np.uint64(17) | entries["sample_begin"].astype(np.uint64))
        order = np.argsort(keys, kind="stable")
        self._keys, self._key_rows = keys[order], self.rows[order]
        twice = np.flatnonzero(self._keys[1:] == self._keys[:-1])
        if twice.size:
            raise self._records.error("damaged", f"block is stored twice (record {self._key_rows[twice[0] + 1]})")
        self.complete = len(self.rows) == self._geometry.total_blocks(self._groups)
