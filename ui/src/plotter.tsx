// A plot in the colours of the scheme, as wide as its place: what all plots of the page share.
import { useEffect, useRef } from 'preact/hooks'
import uPlot from 'uplot'
import 'uplot/dist/uPlot.min.css'
import { colour, isDark } from './theme'

export type Options = Omit<uPlot.Options, 'width' | 'height'>

// Axes in the colours of the scheme.
export const axisLook = () => ({ stroke: colour('text'), grid: { stroke: colour('faint'), width: 1 }, ticks: { stroke: colour('faint'), width: 1 } })

interface Props {
  label: string // for those who cannot see it
  height: number
  most?: number // pixels it is wide
  make: () => Options // anew when `key` changes
  remake: string
  data: uPlot.AlignedData
  onPlot?: (plot: uPlot | null) => void
}

export function Plotter({ label, height, most = Infinity, make, remake, data, onPlot }: Props) {
  const place = useRef<HTMLDivElement>(null)
  const plot = useRef<uPlot | null>(null)
  const newest = useRef(data)
  newest.current = data
  useEffect(() => {
    const wide = () => Math.max(50, Math.min(most, place.current!.clientWidth))
    const made = new uPlot({ ...make(), width: wide(), height }, newest.current, place.current!)
    plot.current = made
    onPlot?.(made)
    const observer = new ResizeObserver(() => made.setSize({ width: wide(), height }))
    observer.observe(place.current!)
    return () => {
      observer.disconnect()
      plot.current = null
      onPlot?.(null)
      made.destroy()
    }
  }, [remake, isDark.value])
  useEffect(() => plot.current?.setData(data), [data])
  return <div class="plotter" ref={place} role="img" aria-label={label} />
}
