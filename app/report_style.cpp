/// The page's look and its one script: a read-out under the pointer. Both are inline; nothing is fetched.
#include "app/report_sections.h"

namespace tuft::app {

std::string report_style() {
  // Series colours: Okabe and Ito (2008), distinguishable with any colour vision.
  return R"css(
:root { color-scheme: light dark;
  --ink:#1b1f24; --soft:#5b6570; --rule:#d5d9de; --grid:#e8ebee; --page:#ffffff; --panel:#f7f8f9;
  --c0:#0072b2; --c1:#d55e00; --c2:#009e73; --c3:#cc79a7; --c4:#a88600; --c5:#3d9bd1;
  --m0:#dcb86f; --m1:#a9805a; --m2:#4c5966; --m3:#8fa3ad; --m4:#b7a99a; --m5:#6d7f5e;
  --strand:#2f8f46; --backing:#8a8f96; --missile:#b9c0c8; --missile-edge:#59626c; --good:#1a7f4b; --bad:#b3261e; }
@media (prefers-color-scheme: dark) { :root {
  --ink:#e4e7ea; --soft:#9aa4ae; --rule:#3a4149; --grid:#2a3037; --page:#15181c; --panel:#1c2025;
  --c0:#56b4e9; --c1:#f08a3c; --c2:#35c99d; --c3:#e29cc4; --c4:#e6c84a; --c5:#9ad3f2;
  --m0:#d9b76f; --m1:#a57c57; --m2:#67747f; --m3:#9fb2bb; --m4:#b7a99a; --m5:#83966f;
  --strand:#4fb868; --backing:#7d858d; --missile:#4a525b; --missile-edge:#a3adb7; --good:#58c08a; --bad:#ff8a80; } }
* { box-sizing:border-box; }
body { margin:0; background:var(--page); color:var(--ink); font:15px/1.5 system-ui,-apple-system,"Segoe UI","Helvetica Neue",Arial,"DejaVu Sans",sans-serif; }
main { max-width:1060px; margin:0 auto; padding:40px 28px 72px; }
h1 { font-size:30px; line-height:1.2; font-weight:600; letter-spacing:-.01em; margin:0 0 14px; }
h2 { font-size:19px; font-weight:600; margin:44px 0 12px; padding-bottom:6px; border-bottom:1px solid var(--rule); }
h3 { font-size:15px; font-weight:600; margin:22px 0 6px; }
dl { display:grid; grid-template-columns:max-content 1fr; gap:2px 18px; margin:0 0 14px; }
dt { color:var(--soft); } dd { margin:0; }
p { margin:8px 0; } p.run { margin:4px 0; }
.note,figcaption,.missing { color:var(--soft); font-size:13px; max-width:84ch; }
.state { font-size:12px; padding:1px 8px; border-radius:9px; border:1px solid currentColor; margin:0 4px; color:var(--soft); }
.state.completed { color:var(--good); } .state.failed,.error,.bad { color:var(--bad); } .good { color:var(--good); }
.good,.bad { font-size:12px; margin-left:6px; } .off { color:var(--soft); }
table { border-collapse:collapse; margin:10px 0; font-variant-numeric:tabular-nums; }
th,td { padding:5px 0 5px 22px; text-align:right; vertical-align:baseline; border-bottom:1px solid var(--grid); font-weight:400; }
th:first-child { text-align:left; padding-left:0; }
thead th { color:var(--soft); font-size:13px; border-bottom:1px solid var(--rule); white-space:nowrap; }
th i { font-style:normal; color:var(--soft); }
table.prose th,table.prose td { text-align:left; } table.prose td { font-size:13.5px; }
.key { display:inline-block; width:10px; height:10px; border-radius:2px; margin-right:7px; background:var(--soft); }
.columns { display:flex; flex-wrap:wrap; gap:12px 48px; align-items:flex-start; }
figure { margin:0; } figure.plot { margin:10px 0 18px; position:relative; }
figure.plot svg { display:block; width:100%; height:auto; overflow:hidden; }
svg text { fill:var(--soft); font-size:12.5px; font-family:inherit; } svg text.label { fill:var(--ink); font-size:13px; }
svg .end { text-anchor:end; } svg .middle { text-anchor:middle; }
.axis .grid { stroke:var(--grid); } .axis .zero,.axis .frame,.axis .tick { stroke:var(--rule); }
polyline,.swatch line { fill:none; stroke-width:2; stroke-linejoin:round; }
polyline.faint,line.faint { stroke-width:1; opacity:.5; } .dashed { stroke-dasharray:6 4; }
line.limit { stroke:var(--bad); stroke-dasharray:5 4; } text.limit { fill:var(--bad); }
.legend { margin:0 0 4px; font-size:13px; color:var(--soft); } .legend span { margin-right:18px; white-space:nowrap; }
.legend .swatch,figure.plot .legend .swatch { display:inline-block; width:auto; vertical-align:middle; margin-right:6px; }
.panels { display:grid; grid-template-columns:repeat(3,1fr); gap:14px; } .panels figcaption { margin-top:4px; }
@media (max-width:760px) { .panels { grid-template-columns:1fr; } }
svg.section { display:block; width:100%; height:auto; background:var(--panel); border-radius:3px; }
svg.section circle { stroke:var(--panel); stroke-width:.12; }
.strand { fill:none; stroke:var(--strand); stroke-linecap:round; } .strand-area { fill:var(--strand); fill-opacity:.16; }
.backing { fill:none; stroke:var(--backing); } .backing-area { fill:var(--backing); }
.missile { fill:var(--missile); stroke:var(--missile-edge); stroke-width:.5; }
.tray { fill:none; stroke:var(--soft); stroke-width:.6; } path.scale { fill:none; stroke:var(--soft); stroke-width:.5; }
svg text.scale { fill:var(--soft); }
.cursor { stroke:var(--soft); stroke-dasharray:2 3; }
.readout { position:absolute; top:0; right:14px; font-size:12.5px; font-variant-numeric:tabular-nums; color:var(--ink); background:var(--page); padding:0 4px; }
.c0{stroke:var(--c0)}.c1{stroke:var(--c1)}.c2{stroke:var(--c2)}.c3{stroke:var(--c3)}.c4{stroke:var(--c4)}.c5{stroke:var(--c5)}
.key.c0{background:var(--c0)}.key.c1{background:var(--c1)}.key.c2{background:var(--c2)}.key.c3{background:var(--c3)}.key.c4{background:var(--c4)}.key.c5{background:var(--c5)}
.m0{fill:var(--m0)}.m1{fill:var(--m1)}.m2{fill:var(--m2)}.m3{fill:var(--m3)}.m4{fill:var(--m4)}.m5{fill:var(--m5)}
.e0{stroke:var(--ink)}.e1{stroke:#0072b2}.e2{stroke:#d55e00}.e3{stroke:#56b4e9}.e4{stroke:#009e73}.e5{stroke:#8fd3bd}.e6{stroke:#cc79a7}
.e7{stroke:#e69f00}.e8{stroke:#b8a200}.e9{stroke:#8c6bb1}.e10{stroke:#7f7f7f}.e11{stroke:#a65628}.e12{stroke:#f781bf}.e13{stroke:#984ea3}.e14{stroke:#17becf}.e15{stroke:#66a61e}
.p0{fill:#9aa5b1}.p1{fill:#6b7885}.p2{fill:#f2c879}.p3{fill:#e69f00}.p4{fill:#009e73}.p5{fill:#0072b2}.p6{fill:#cc79a7}.p7{fill:#56b4e9}.p8{fill:#8c6bb1}.p9{fill:#b8a200}.p10{fill:#c3ccd5}.p11{fill:#a65628}.p12{fill:#1b9e77}
.key.p0{background:#9aa5b1}.key.p1{background:#6b7885}.key.p2{background:#f2c879}.key.p3{background:#e69f00}.key.p4{background:#009e73}.key.p5{background:#0072b2}.key.p6{background:#cc79a7}.key.p7{background:#56b4e9}.key.p8{background:#8c6bb1}.key.p9{background:#b8a200}.key.p10{background:#c3ccd5}.key.p11{background:#a65628}.key.p12{background:#1b9e77}
@media print { body { font-size:11pt; } main { max-width:none; padding:0; } section { break-inside:avoid-page; } }
)css";
}

std::string report_script() {
  return R"js(
document.querySelectorAll('figure.plot svg[data-x]').forEach(svg => {
  const X = svg.dataset.x.split(' ').map(Number), Y = svg.dataset.y.split(' ').map(Number);
  const value = (p, a) => a[0] + (p - a[2]) / (a[3] - a[2]) * (a[1] - a[0]);
  const curves = [...svg.querySelectorAll('polyline[data-label]')].map(p => ({ label: p.dataset.label,
    points: p.getAttribute('points').split(' ').map(s => s.split(',').map(Number)) }));
  const cursor = document.createElementNS(svg.namespaceURI, 'line'), out = document.createElement('div');
  cursor.setAttribute('class', 'cursor'); cursor.setAttribute('y1', Y[3]); cursor.setAttribute('y2', Y[2]);
  out.className = 'readout';
  svg.addEventListener('pointermove', event => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse()).x;
    if (at < X[2] || at > X[3]) return;
    cursor.setAttribute('x1', at); cursor.setAttribute('x2', at);
    svg.append(cursor); svg.parentNode.append(out);
    out.textContent = value(at, X).toPrecision(3) + ' ' + (svg.dataset.unit || 'ms') + '   ' + curves.map(c => {
      const near = c.points.reduce((a, b) => Math.abs(b[0] - at) < Math.abs(a[0] - at) ? b : a);
      return Math.abs(near[0] - at) > 8 ? '' : c.label + ' ' + value(near[1], Y).toPrecision(3);
    }).filter(Boolean).join('   ');
  });
  svg.addEventListener('pointerleave', () => { cursor.remove(); out.remove(); });
});
)js";
}

}  // namespace tuft::app
