// How nodes and edges look, in the colours of the scheme.
import type cytoscape from 'cytoscape'
import { kNode } from './layout'
import { colour } from './theme'
import type { Tone } from './looks'

export const kLeastText = 7 // pixels: what is smaller is no text
export const kLeastZoom = 0.5 // at which the names of nodes can be read

const kShapes: Partial<Record<Tone, string>> = {
  OK: 'round-rectangle',
  NON_CRITICAL: 'barrel',
  WARNING: 'hexagon',
  ERROR: 'octagon',
  EXHAUSTED: 'octagon',
  blind: 'round-rectangle',
  unknown: 'round-rectangle',
}

export function stylesheet(): cytoscape.StylesheetStyle[] {
  const tones = (Object.keys(kShapes) as Tone[]).map((tone) => ({
    selector: `node[tone = "${tone}"]`,
    style: {
      shape: kShapes[tone] as cytoscape.Css.NodeShape,
      'background-color': colour(`${tone}-fill`),
      'border-color': colour(tone),
    },
  }))
  return [
    {
      selector: 'node',
      style: {
        label: 'data(label)',
        'text-wrap': 'wrap',
        'text-valign': 'center',
        'line-height': 1.2,
        'font-size': 17,
        'min-zoomed-font-size': kLeastText,
        'font-family': 'system-ui, sans-serif',
        color: colour('text'),
        width: kNode.width,
        height: kNode.height,
        'border-width': 2,
        'z-index-compare': 'manual',
        'z-index': 2,
      },
    },
    ...tones,
    {
      selector: 'node[!isManaged][!isGroup]',
      style: { 'border-style': 'dotted', 'background-opacity': 0.5, 'font-size': 13, height: 44 },
    },
    // No rule judges it: neither well nor ill.
    { selector: 'node[tone = "blind"]', style: { 'border-style': 'double', 'border-width': 6 } },
    { selector: 'node[!isPresent][!isGroup]', style: { 'border-style': 'dashed', 'background-opacity': 0.3 } },
    {
      selector: 'node[?isCulprit]',
      style: {
        'border-width': 6,
        'border-color': colour('culprit'),
        'font-weight': 'bold',
        'underlay-color': colour('culprit'),
        'underlay-padding': 8,
        'underlay-opacity': 0.25,
      },
    },
    {
      selector: 'node[?isGroup]',
      style: {
        shape: 'round-rectangle',
        width: 'data(w)' as never,
        height: 'data(h)' as never,
        'text-valign': 'top',
        'text-margin-y': -4,
        'font-size': 'data(size)' as never,
        'font-weight': 'bold',
        'min-zoomed-font-size': 0,
        'background-opacity': 0.3,
        'border-style': 'solid',
        'border-width': 2,
        'underlay-opacity': 0,
        'z-index': 0,
      },
    },
    { selector: 'node[?isGroup][?isCulprit]', style: { 'border-color': colour('culprit'), 'border-width': 'mapData(size, 15, 170, 5, 30)' as never } },
    { selector: 'edge[?isGroup]', style: { display: 'none', label: '', 'curve-style': 'straight', width: 12 } },
    // From far away.
    { selector: 'node[?isGroup].far', style: { 'text-valign': 'center', 'text-margin-y': 0, 'background-opacity': 1 } },
    { selector: 'edge[?isGroup].far', style: { display: 'element', 'line-color': colour('faint'), 'target-arrow-color': colour('faint') } },
    { selector: 'edge[?isGroup][?isCascade].far', style: { width: 30, 'line-color': colour('culprit'), 'target-arrow-color': colour('culprit') } },
    { selector: 'node[!isGroup].far', style: { display: 'none' } },
    { selector: 'edge[!isGroup].far', style: { display: 'none' } },
    { selector: 'node:selected', style: { 'overlay-color': colour('accent'), 'overlay-opacity': 0.15 } },
    {
      selector: 'edge',
      style: {
        label: 'data(label)',
        'font-size': 13,
        'text-wrap': 'wrap',
        'min-zoomed-font-size': kLeastText,
        'font-family': 'system-ui, sans-serif',
        color: colour('text'),
        'text-background-color': colour('surface'),
        'text-background-opacity': 1,
        'text-background-padding': '2px',
        'text-margin-y': 'data(aside)' as never, // beside the edge, which stays to be seen
        'text-background-shape': 'roundrectangle',
        'curve-style': 'bezier',
        'target-arrow-shape': 'triangle',
        'line-color': colour('line'),
        'target-arrow-color': colour('line'),
        width: 1.5,
        'z-index-compare': 'manual',
        'z-index': 1,
      },
    },
    {
      selector: 'edge[?isLong]',
      style: { 'curve-style': 'unbundled-bezier', 'control-point-distances': 'data(bend)' as never, 'control-point-weights': [0.5] },
    },
    {
      selector: 'edge[?isSilent]',
      style: {
        'line-style': 'dashed',
        'line-color': colour('ERROR'),
        'target-arrow-color': colour('ERROR'),
        color: colour('ERROR'),
      },
    },
    {
      selector: 'edge[?isCascade]',
      style: { width: 5, 'line-color': colour('culprit'), 'target-arrow-color': colour('culprit') },
    },
  ]
}

