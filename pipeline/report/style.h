// The style sheet of report.html. Every pair of text and background keeps the contrast of WCAG 2.2, 1.4.6 (7:1; a test
// computes it).
#pragma once

namespace sparsha::pipeline {

inline constexpr const char* kReportStyle = R"css(
:root{--paper:#faf8f4;--card:#ffffff;--ink:#1f1b16;--soft:#57503f;--accent:#7a3e12;--line:#d8d0c2;--warn:#fff1d6;--warnink:#5c3a00;--bar:#8a5a2b;--head:#f1ece2}
*{box-sizing:border-box}
html{font:100%/1.55 "Source Sans 3","Segoe UI",system-ui,-apple-system,"DejaVu Sans",sans-serif;color:var(--ink);background:var(--paper);-webkit-text-size-adjust:100%}
body{margin:0}
.skip{position:absolute;left:-999rem;background:var(--ink);color:#fff;padding:.6rem 1rem}
.skip:focus{left:1rem;top:1rem;z-index:9}
header,main,footer{max-width:78rem;margin:0 auto;padding:0 clamp(1rem,4vw,3rem)}
header{padding-top:2.6rem}
h1{font:600 clamp(1.9rem,4vw,2.9rem)/1.15 Georgia,"DejaVu Serif",serif;margin:.1em 0 .35em;overflow-wrap:anywhere}
h2{font:600 1.55rem/1.25 Georgia,"DejaVu Serif",serif;margin:3rem 0 .8rem;padding-top:1.1rem;border-top:1px solid var(--line)}
h3{font-size:1.1rem;margin:0 0 .3rem}
.kicker{color:var(--accent);font-weight:600;letter-spacing:.06em;margin:0}
.lead{font-size:1.18rem;max-width:46rem;margin:.2rem 0 1.4rem}
nav ul{display:flex;flex-wrap:wrap;gap:.3rem 1.3rem;list-style:none;padding:0;margin:0 0 1.2rem}
a{color:var(--accent);text-underline-offset:.18em}
a:focus-visible,pre:focus-visible,summary:focus-visible,.scroll:focus-visible{outline:3px solid var(--accent);outline-offset:2px}
.figures{display:grid;grid-template-columns:repeat(auto-fit,minmax(11.5rem,1fr));gap:1rem;margin:0;padding:0}
.figures div{background:var(--card);border:1px solid var(--line);border-radius:.5rem;padding:.9rem 1.1rem}
.figures dt{color:var(--soft);font-size:.92rem}
.figures dd{margin:.1rem 0 0;font-size:1.42rem;font-weight:600;line-height:1.3}
.figures dd small{display:block;font-size:.86rem;font-weight:400;color:var(--soft)}
.warnings{background:var(--warn);color:var(--warnink);border-left:.4rem solid #b86e00;border-radius:.3rem;padding:.8rem 1.2rem}
.warnings ul{margin:.2rem 0;padding-left:1.2rem}
.gallery{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,21rem),1fr));gap:1.6rem}
figure{margin:0;background:var(--card);border:1px solid var(--line);border-radius:.5rem;padding:1rem;break-inside:avoid;display:flex;flex-direction:column}
figure.wide{grid-column:1/-1}
.picture{position:relative;width:fit-content;max-width:100%;margin:0 auto}
.picture img{display:block;max-width:100%;height:auto}
figure.wide .picture img{max-height:46rem;width:auto}
figure.tiny .picture img{image-rendering:pixelated}
.bar{position:absolute;left:2.5%;bottom:2.5%;height:.5rem;border:2px solid #111;border-top:0;box-shadow:0 0 0 1.5px #fff,inset 0 0 0 1px #fff;background:#111}
.bar span{position:absolute;bottom:.75rem;left:0;white-space:nowrap;background:#fff;color:#111;font-size:.85rem;line-height:1.2;padding:.05rem .35rem;border-radius:.2rem}
figcaption{margin-top:.7rem;font-size:.95rem;color:var(--soft)}
figcaption h3{color:var(--ink)}
figcaption p{margin:.1rem 0}
.legend{width:100%;max-width:24rem;margin:.6rem auto 0;display:block}
svg text{font:13px "Source Sans 3","Segoe UI",system-ui,"DejaVu Sans",sans-serif;fill:var(--ink);text-anchor:middle}
svg text.start{text-anchor:start}
svg line{stroke:var(--ink);stroke-width:1}
svg .frame{stroke:var(--ink);stroke-width:.7}
.histogram{width:100%;max-width:46rem;display:block}
.histogram .bars{fill:var(--bar)}
.histogram .marks line{stroke-width:1.6;stroke-dasharray:4 3}
.scroll{overflow-x:auto}
table{border-collapse:collapse;background:var(--card);border:1px solid var(--line);margin:.6rem 0 1.2rem;font-variant-numeric:tabular-nums}
caption{text-align:left;color:var(--soft);padding:.2rem 0 .5rem}
th,td{padding:.42rem .9rem;text-align:right;border-bottom:1px solid var(--line);vertical-align:top}
th[scope=row],th.text,td.text{text-align:left;font-weight:400}
thead th{font-weight:600;background:var(--head)}
code,pre{font:.86rem/1.5 "DejaVu Sans Mono",ui-monospace,Consolas,monospace}
code.hash{overflow-wrap:anywhere}
pre{background:var(--card);border:1px solid var(--line);border-radius:.4rem;padding:1rem;overflow:auto;max-height:34rem}
dl.words dt{font-weight:600;margin-top:.6rem}
dl.words dd{margin:0;max-width:46rem}
.columns{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,28rem),1fr));gap:1rem 2.5rem}
summary{cursor:pointer;color:var(--accent);padding:.3rem 0}
footer{color:var(--soft);padding-top:1rem;padding-bottom:3rem;font-size:.92rem;margin-top:2rem}
@media print{html{background:#fff;font-size:80%}nav,.skip{display:none}pre{max-height:none;white-space:pre-wrap}figure,.figures div{break-inside:avoid}h2{break-after:avoid}}
)css";

}  // namespace sparsha::pipeline
