// Decodes the OpenEXR files that irsig stores: scan lines of one float32 channel, packed as run
// lengths or with zlib. The layout: openexr.com, "OpenEXR File Layout".

const LINES_OF_BLOCK = [1, 1, 1, 16];  // by the method: none, run lengths, zlib, zlib
const RUN_LENGTHS = 1;
const damaged = (what) => new Error(`its pixels are damaged: ${what}`);

// Returns {method, width, height, at}: at is where the places of the blocks begin.
function header(view) {
  let at = 8;
  const text = () => {
    let out = "";
    for (let code; (code = view.getUint8(at++)) !== 0;) out += String.fromCharCode(code);
    return out;
  };
  const out = {};
  while (view.getUint8(at) !== 0) {
    const name = text();
    text();  // the type of the attribute
    const size = view.getUint32(at, true);
    at += 4;
    if (name === "compression") out.method = view.getUint8(at);
    if (name === "dataWindow") {
      out.width = view.getInt32(at + 8, true) + 1;
      out.height = view.getInt32(at + 12, true) + 1;
    }
    at += size;
  }
  return { ...out, at: at + 1 };
}

function unpackRuns(packed, size) {
  const out = new Uint8Array(size);
  let from = 0, to = 0;
  while (from < packed.length) {
    const count = packed[from++];
    const length = count > 127 ? 256 - count : count + 1;
    if (to + length > size || from + (count > 127 ? length : 1) > packed.length) throw damaged("a run is too long");
    if (count > 127) out.set(packed.subarray(from, from + length), to);
    else out.fill(packed[from], to, to + length);
    from += count > 127 ? length : 1;
    to += length;
  }
  if (to !== size) throw damaged("a block is too short");
  return out;
}

// Inflates to `size` bytes and no more, whatever the packed bytes stand for.
async function inflate(packed, size) {
  const reader = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate")).getReader();
  const out = new Uint8Array(size);
  let to = 0;
  for (;;) {
    const { done, value } = await reader.read().catch(() => {
      throw damaged("a block cannot be inflated");
    });
    if (done) break;
    if (to + value.length > size) {
      reader.cancel().catch(() => {});
      throw damaged("a block is too long");
    }
    out.set(value, to);
    to += value.length;
  }
  if (to !== size) throw damaged("a block is too short");
  return out;
}

// Even bytes stand before odd ones, each as the difference from the byte before.
function unfilter(bytes, out) {
  const half = (bytes.length + 1) >> 1;
  let last = bytes[0];
  for (let k = 0, to = 0; k < bytes.length; ++k, to += 2) {
    if (k > 0) last = (last + bytes[k] - 128) & 255;
    if (k === half) to = 1;
    out[to] = last;
  }
}

async function decoded(buffer, wanted) {
  const view = new DataView(buffer), { method, width, height, at } = header(view);
  const lines = LINES_OF_BLOCK[method];
  if (lines === undefined) throw damaged("they are packed in a way that this page cannot read");
  if (width !== wanted.width || height !== wanted.height) throw damaged("they are of another size");
  // Every processor that browsers run on has the byte order of the file.
  const out = new Float32Array(width * height);
  const block = async (k) => {
    const place = Number(view.getBigUint64(at + 8 * k, true));
    const first = view.getInt32(place, true), packedSize = view.getUint32(place + 4, true);
    if (first !== k * lines) throw damaged("a block is out of order");
    const size = 4 * width * Math.min(lines, height - first);
    const packed = new Uint8Array(buffer, place + 8, packedSize), pixels = new Uint8Array(out.buffer, 4 * first * width, size);
    if (packedSize > size) throw damaged("a block is too long");
    if (packedSize === size) pixels.set(packed);
    else unfilter(method === RUN_LENGTHS ? unpackRuns(packed, size) : await inflate(packed, size), pixels);
  };
  await Promise.all(Array.from({ length: Math.ceil(height / lines) }, (_, k) => block(k)));
  return out;
}

// Returns the pixels, row by row from the top left; size: {width, height} that the file must have.
export async function decodeExr(buffer, size) {
  try {
    return await decoded(buffer, size);
  } catch (error) {
    throw error instanceof RangeError ? damaged("the file is cut off") : error;
  }
}
