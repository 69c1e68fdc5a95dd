// SPDX-License-Identifier: Apache-2.0
// Files in one ZIP, as they are: images are compressed already. The format: PKWARE, APPNOTE 6.3,
// sections 4.3.7, 4.3.12 and 4.3.16, without the extensions of ZIP64.

const kLocalFile = 0x04034b50;
const kCentralFile = 0x02014b50;
const kEnd = 0x06054b50;
const kVersion = 20;
const kUtf8 = 0x0800; // names
const kStored = 0;
const kNoDate = 0x21; // 1 January 1980, the first one that there is

const kTable = Uint32Array.from({ length: 256 }, (_, byte) => {
  let rest = byte;
  for (let bit = 0; bit < 8; ++bit) rest = rest & 1 ? 0xedb88320 ^ (rest >>> 1) : rest >>> 1;
  return rest;
});

/** The checksum of a ZIP, of bytes that stand behind others whose checksum is `before`. */
export function crc32(bytes, before = 0) {
  let rest = ~before;
  for (const byte of bytes) rest = kTable[(rest ^ byte) & 255] ^ (rest >>> 8);
  return ~rest >>> 0;
}

/** A file for a ZIP, to which bytes are added one after another. */
export class StoredFile {
  parts = [];
  length = 0;
  checksum = 0;

  constructor(name) {
    this.name = name;
  }

  /** `kept` are the same bytes in another form, such as a Blob. */
  add(bytes, kept = bytes) {
    this.parts.push(kept);
    this.length += bytes.length;
    this.checksum = crc32(bytes, this.checksum);
    return this;
  }
}

const short = (value) => ({ size: 2, value });
const long = (value) => ({ size: 4, value });

/** Numbers one behind another, little-endian. */
function packed(...numbers) {
  const view = new DataView(new ArrayBuffer(numbers.reduce((sum, { size }) => sum + size, 0)));
  let at = 0;
  for (const { size, value } of numbers) {
    if (size === 2) view.setUint16(at, value, true);
    else view.setUint32(at, value, true);
    at += size;
  }
  return new Uint8Array(view.buffer);
}

/** The files as one Blob; at most 65534 of them, of less than 4 GiB in all. */
export function zip(files) {
  const contents = [];
  const directory = [];
  let at = 0;
  for (const { name, parts, length, checksum } of files) {
    const name_bytes = new TextEncoder().encode(name);
    const about = [
      ...[kVersion, kUtf8, kStored, 0, kNoDate].map(short),
      ...[checksum, length, length].map(long),
      ...[name_bytes.length, 0].map(short),
    ];
    const head = packed(long(kLocalFile), ...about);
    const attributes = [...[0, 0, 0].map(short), long(0)];
    directory.push(
      packed(long(kCentralFile), short(kVersion), ...about, ...attributes, long(at)),
      name_bytes,
    );
    contents.push(head, name_bytes);
    for (const part of parts) contents.push(part);
    at += head.length + name_bytes.length + length;
  }
  const directory_length = directory.reduce((sum, part) => sum + part.length, 0);
  const counts = [0, 0, files.length, files.length].map(short);
  const end = packed(long(kEnd), ...counts, long(directory_length), long(at), short(0));
  return new Blob([...contents, ...directory, end], { type: "application/zip" });
}
