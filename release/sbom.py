"""Bills of materials, SPDX 2.3 as JSON: every file with its checksums, and whose work is in it."""

from __future__ import annotations

import hashlib
import json
import os
import re
import time
from collections.abc import Mapping, Sequence
from typing import Any

from release.archives import EARLIEST
from release.parts import Part

__all__ = ["document"]

NAMESPACE = "https://spdx.org/spdxdocs/giveway"
OWN = "SPDXRef-giveway"


def _id(kind: str, name: str) -> str:
    """Allowed by SPDX, and different for different names."""
    return f"SPDXRef-{kind}-{re.sub(r'[^A-Za-z0-9.]+', '-', name)}-{hashlib.sha256(name.encode()).hexdigest()[:8]}"


def _package(part: Part) -> dict[str, Any]:
    origin = part.origin()
    found: dict[str, Any] = {
        "SPDXID": _id("part", part.name),
        "name": part.name,
        "versionInfo": part.version or origin.version,
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False,
        "licenseConcluded": part.licence,
        "licenseDeclared": part.licence,
        "copyrightText": "NOASSERTION",
        "comment": f"fetched inside {origin.url}",
        "externalRefs": [
            {"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": origin.url}
        ],
    }
    if len(origin.checksums) == 1:
        found["checksums"] = [{"algorithm": origin.algorithm, "checksumValue": origin.checksums[0]}]
    else:
        found["comment"] += f", one of the files with {origin.algorithm} {', '.join(origin.checksums)}"
    return found


def _file(name: str, data: bytes) -> dict[str, Any]:
    sums = [("SHA1", hashlib.sha1(data)), ("SHA256", hashlib.sha256(data))]  # SPDX 2.3 demands SHA-1
    return {
        "SPDXID": _id("file", name),
        "fileName": f"./{name}",
        "checksums": [{"algorithm": kind, "checksumValue": found.hexdigest()} for kind, found in sums],
        "licenseConcluded": "NOASSERTION",
        "copyrightText": "NOASSERTION",
    }


def _verification(files: Sequence[Mapping[str, Any]]) -> str:
    """SPDX's package verification code."""
    sums = sorted(file["checksums"][0]["checksumValue"] for file in files)
    return hashlib.sha1("".join(sums).encode()).hexdigest()


def document(
    name: str, version: str, contents: Mapping[str, bytes], parts: Sequence[Part], holds: Mapping[str, Sequence[Part]]
) -> bytes:
    """Of an archive ``name`` with ``contents`` (name -> bytes); ``holds``: file -> the parts inside it."""
    files = [_file(path, contents[path]) for path in sorted(contents)]
    own = {
        "SPDXID": OWN,
        "name": "giveway",
        "versionInfo": version,
        "packageFileName": name,
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": True,
        "packageVerificationCode": {"packageVerificationCodeValue": _verification(files)},
        "hasFiles": [file["SPDXID"] for file in files],
        "licenseConcluded": " AND ".join(
            f"({one})" if " " in one else one for one in dict.fromkeys(["MIT", *(part.licence for part in parts)])
        ),
        "licenseDeclared": "MIT",
        "licenseInfoFromFiles": ["NOASSERTION"],
        "copyrightText": "NOASSERTION",
    }
    related = [("SPDXRef-DOCUMENT", "DESCRIBES", OWN)]
    related += [(OWN, "CONTAINS", _id("part", part.name)) for part in parts]
    related += [
        (_id("file", path), "CONTAINS", _id("part", part.name)) for path in sorted(holds) for part in holds[path]
    ]
    when = time.gmtime(max(int(os.environ.get("SOURCE_DATE_EPOCH", EARLIEST)), EARLIEST))
    found = {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": name,
        "documentNamespace": f"{NAMESPACE}/{name}-{_verification(files)}",
        "creationInfo": {"created": time.strftime("%Y-%m-%dT%H:%M:%SZ", when), "creators": ["Tool: giveway-release"]},
        "packages": [own, *(_package(part) for part in parts)],
        "files": files,
        "hasExtractedLicensingInfos": [
            {"licenseId": part.licence, "name": part.name, "extractedText": part.text()}
            for part in parts
            if part.licence.startswith("LicenseRef-")
        ],
        "relationships": [
            {"spdxElementId": a, "relationshipType": kind, "relatedSpdxElement": b} for a, kind, b in related
        ],
    }
    return (json.dumps(found, indent=1) + "\n").encode()
