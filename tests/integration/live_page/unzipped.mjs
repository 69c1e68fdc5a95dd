// SPDX-License-Identifier: Apache-2.0
import { execFileSync } from "node:child_process";

// A program other than the page lists the content, and checks the checksums.
const kReader = `
import base64, json, sys, zipfile
with zipfile.ZipFile(sys.argv[1]) as archive:
    assert archive.testzip() is None, archive.testzip()
    files = {name: base64.b64encode(archive.read(name)).decode() for name in archive.namelist()}
print(json.dumps(files))
`;

/** The files of a ZIP, as Buffers by their names. */
export function unzipped(file) {
  const maxBuffer = 2 ** 28;
  const printed = execFileSync("python3", ["-c", kReader, file], { encoding: "utf8", maxBuffer });
  const files = Object.entries(JSON.parse(printed));
  return Object.fromEntries(files.map(([name, text]) => [name, Buffer.from(text, "base64")]));
}

/** The head of a file of NumPy, and its numbers as those of a type of ours. */
export function numpy_array(bytes, Type) {
  const start = 10 + bytes.readUInt16LE(8);
  const head = bytes.subarray(10, start).toString("latin1").trim();
  const numbers = new Type(Uint8Array.from(bytes.subarray(start)).buffer);
  return { magic: bytes.subarray(0, 8).toString("latin1"), start, head, numbers: [...numbers] };
}
