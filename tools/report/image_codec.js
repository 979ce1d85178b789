// Undoes image_packing.py: base64, deflate, bytes sorted by weight, half floats, floats or counts.
let halfTable = null;
function halfValues() {
  if (halfTable) return halfTable;
  halfTable = new Float32Array(65536);
  for (let bits = 0; bits < 65536; ++bits) {
    const sign = bits & 0x8000 ? -1 : 1, exponent = (bits >> 10) & 31, fraction = bits & 1023;
    halfTable[bits] = exponent === 0 ? sign * fraction * 2 ** -24 :
      exponent < 31 ? sign * (1 + fraction / 1024) * 2 ** (exponent - 15) :
        fraction ? NaN : sign * Infinity;
  }
  return halfTable;
}

// Float32Array [y][x][c]
async function unpackImage(index) {
  const {width, height, channels, kind, scale} = report.pictures.images[index];
  const text = atob(document.getElementById(`image-${index}`).textContent);
  const packed = Uint8Array.from(text, (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const pixels = width * height, size = pixels * channels, values = new Float32Array(size);
  const table = kind === 'half' ? halfValues() : null, word = new DataView(new ArrayBuffer(4));
  const floatAt = (i) => {
    for (let b = 0; b < 4; ++b) word.setUint8(3 - b, bytes[b * size + i]);
    return word.getFloat32(0);
  };
  for (let c = 0, i = 0; c < channels; ++c) {
    for (let p = 0; p < pixels; ++p, ++i) {
      const bits = bytes[i] | (bytes[size + i] << 8);
      values[p * channels + c] = kind === 'float' ? floatAt(i) : (table ? table[bits] : bits) * scale;
    }
  }
  return values;
}
