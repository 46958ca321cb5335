"""Chooses what a render is measured against: the photograph, or the table measured on it."""

from .photograph import encoding_warning
from .regions import remeasure


def choose_reference(table, photograph):
    """The regions to score and the report's account of them.

    A photograph that is not the table's own file is measured again with the
    same polygons, and the report says so; so is one that the lens was taken out of.
    """
    warnings = []
    if photograph is None:
        reference = {"kind": "region_table", "file": table.photo["file"], "sha256": table.photo["sha256"], "encoding": table.photo["encoding"]}
        regions = table.regions
    else:
        reference = {"kind": "photograph", "file": photograph.file, "sha256": photograph.sha256, "encoding": photograph.encoding}
        regions = table.regions
        if photograph.sha256 != table.photo["sha256"]:
            warnings.append(
                f"{photograph.file}: SHA-256 differs from that of {table.photo['file']} in the region table; the regions were measured again on the given photograph"
            )
            regions = remeasure(table, photograph)
        elif photograph.corrections:
            regions = remeasure(table, photograph)
        reference |= {
            "regions_measured_again": regions is not table.regions, "corrections": list(photograph.corrections), "exposure": photograph.exposure,
            "saturated_pixels": {region.name: region.saturated for region in regions if region.saturated},
        }
        if any(region.dark for region in regions) and all(region.dark for region in regions):
            warnings.append(f"{photograph.file}: every region is at the black level")
    warnings += filter(None, [encoding_warning(reference["file"], reference["encoding"])])
    return regions, reference | {"table_sha256": table.photo["sha256"], "space": table.space, "provenance": table.provenance, "warnings": warnings}
