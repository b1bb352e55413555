// SPDX-License-Identifier: MIT
// node levels.mjs FILE: what copc.js with laz-perf, as viewers in browsers use them, finds in a COPC file.
// Prints a line for each level: its number, its points, and the sums of their whole-numbered coordinates.
import copcJs from 'copc'
import lazPerfJs from 'laz-perf'

const { Copc } = copcJs
const file = process.argv[2]
const copc = await Copc.create(file)
const lazPerf = await lazPerfJs.createLazPerf()
const stride = copc.header.pointDataRecordLength
const levels = new Map()

async function takeNode(level, node) {
  if (node.pointCount === 0) return
  const bytes = await Copc.loadPointDataBuffer(file, copc.header, node, lazPerf)
  if (bytes.length !== node.pointCount * stride) throw new Error(`a node of level ${level} has ${bytes.length} bytes`)
  const records = new DataView(bytes.buffer, bytes.byteOffset, bytes.length)
  const sums = levels.get(level) ?? [0n, 0n, 0n, 0n]
  levels.set(level, sums)
  sums[0] += BigInt(node.pointCount)
  for (let at = 0; at < bytes.length; at += stride)
    for (let axis = 0; axis < 3; ++axis) sums[axis + 1] += BigInt(records.getInt32(at + 4 * axis, true))
  // Viewers read attributes, those of extra bytes too, by their names.
  await Copc.loadPointDataView(file, copc, node, { lazPerf })
}

const pages = [copc.info.rootHierarchyPage]
while (pages.length > 0) {
  const { nodes, pages: more } = await Copc.loadHierarchyPage(file, pages.pop())
  for (const [name, node] of Object.entries(nodes)) await takeNode(Number(name.split('-')[0]), node)
  pages.push(...Object.values(more))
}
for (const level of [...levels.keys()].sort((a, b) => a - b)) console.log(level, levels.get(level).join(' '))
