const all=s=>document.querySelectorAll(s);
const show=n=>{all("[data-level]").forEach(s=>s.hidden=s.dataset.level!==n);all("[data-tab]").forEach(b=>b.setAttribute("aria-selected",b.dataset.tab===n));all("[data-row]").forEach(r=>r.classList.toggle("pick",r.dataset.row===n))};
all("[data-tab]").forEach(b=>b.onclick=()=>show(b.dataset.tab));all("[data-row]").forEach(r=>{r.style.cursor="pointer";r.onclick=()=>show(r.dataset.row)});
const first=document.querySelector("[data-level]:not([hidden])");if(first)show(first.dataset.level);
const box=document.getElementById("outline");
if(box){const mark=()=>document.body.classList.toggle("show",box.checked);box.onchange=mark;mark()}
all("tr[data-name]").forEach(r=>{const point=on=>all(".outlines").forEach(s=>{s.classList.toggle("point",on&&!(box&&box.checked));s.querySelectorAll("polygon").forEach(p=>p.classList.toggle("here",on&&p.dataset.region===r.dataset.name))});r.onmouseenter=()=>point(true);r.onmouseleave=()=>point(false)});
let cut=50;
const slide=x=>{cut=Math.max(0,Math.min(100,x));document.documentElement.style.setProperty("--cut",cut+"%");all(".slider").forEach(s=>s.setAttribute("aria-valuenow",Math.round(cut)))};
all(".slider").forEach(s=>{s.tabIndex=0;for(const [name,value] of [["role","slider"],["aria-label","share of the photograph shown, percent"],["aria-valuemin",0],["aria-valuemax",100],["aria-valuenow",50]])s.setAttribute(name,value);
const move=e=>{const r=s.getBoundingClientRect();slide(100*(e.clientX-r.left)/r.width)};s.onpointerdown=e=>{s.setPointerCapture(e.pointerId);move(e)};s.onpointermove=e=>{if(e.buttons)move(e)};s.ondragstart=()=>false;
s.onkeydown=e=>{const step={ArrowLeft:-2,ArrowRight:2}[e.key];if(step){slide(cut+step);e.preventDefault()}}});
