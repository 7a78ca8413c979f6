// The words of the page: English, Chinese. What the machine says comes from it in the language that is asked for.

const WORDS = {
  example: ["Example", "示例"],
  share: ["Copy link", "复制链接"],
  shared: ["Link copied", "链接已复制"],
  address: ["Link in the address", "链接在地址栏中"],
  text: ["Program", "程序"],
  mode: ["Mode", "状态"],
  line: ["Line", "行"],
  time: ["Time", "时间"],
  worst: ["Worst", "最大误差"],
  run: ["Run", "运行"],
  hold: ["Hold", "进给保持"],
  resume: ["Resume", "继续"],
  reset: ["Reset", "复位"],
  speed: ["Speed", "速度"],
  path: ["Path Z–X (wheel zooms, drag moves)", "轨迹 Z–X(滚轮缩放,拖动平移)"],
  fit: ["Fit", "全部"],
  phase: ["Axis against spindle angle × lead, over Z", "轴位置与主轴角度×螺距之差,按 Z"],
  settings: ["Machine (from the next run)", "机床(下次运行生效)"],
  ripple: ["Spindle ripple", "主轴转速波动"],
  hertz: ["Its frequency", "波动频率"],
  counts: ["Encoder counts a turn", "编码器每转脉冲"],
  own: ["of the machine", "机床设定"],
  kv: ["Drive gain Kv", "驱动器增益 Kv"],
  ideal: ["ideal", "理想"],
  hash: ["Hash of the setpoints", "设定值校验和"],
  fault: ["Fault", "故障"],
  inject: ["Let it happen", "触发"],
  estop: ["Emergency stop pressed", "按下急停"],
  spindle_stalls: ["Spindle stalls", "主轴堵转"],
  spindle_slow: ["Spindle at 70 % of its speed", "主轴降到 70 % 转速"],
  encoder_slips: ["Encoder gains 40 counts", "编码器多计 40 个脉冲"],
  drive_hot: ["Drive of Z too hot", "Z 驱动器过热"],
  drive_silent: ["Drive of Z silent", "Z 驱动器无应答"],
  axis_blocked: ["Axis Z blocked", "Z 轴卡住"],
  bus_unplugged: ["Bus cable pulled out", "总线电缆拔出"],
  measure: ["Measure the threads", "测量螺纹"],
  measured: ["Threads as an inspector measures them (edge of the norm's shape)", "螺纹检验(刀刃按标准牙型)"],
  within: ["within tolerance", "合格"],
  out: ["OUT OF TOLERANCE", "超差"],
  unjudged: ["not judged: there are no limits", "未判定:没有公差"],
  none: ["no full groove to measure", "没有可测量的完整牙槽"],
  no_norm: ["of no norm", "非标准"],
  diameter: ["Diameter", "直径"],
  lowest: ["lowest", "下限"],
  highest: ["highest", "上限"],
  found: ["measured", "实测"],
  major: ["major", "大径"],
  pitch: ["pitch", "中径"],
  minor: ["minor", "小径"],
  functional: ["functional", "作用中径"],
  flanks: ["flanks −Z, +Z", "牙侧角 −Z、+Z"],
  lead: ["lead error over all turns", "累积导程误差"],
  sway: ["drunkenness", "周期误差"],
  turns: ["turns", "圈"],
  go: ["GO goes on", "通规可以通过"],
  go_not: ["GO does not go on", "通规不能通过"],
  no_go: ["NO-GO stays out", "止规不能旋入"],
  no_go_in: ["NO-GO enters", "止规旋入"],
  cut_in: ["Cut-in", "进刀方式"],
  centre: ["down the centre", "沿中线"],
  left: ["down the −Z flank", "沿 −Z 牙侧"],
  right: ["down the +Z flank", "沿 +Z 牙侧"],
  right_centre: ["+Z flank and centre in turn", "+Z 牙侧与中线交替"],
  left_right: ["−Z and +Z flank in turn", "−Z 与 +Z 牙侧交替"],
  trailing: ["down the flank that trails the feed", "沿进给后侧牙侧"],
  pass: ["Pass", "走刀"],
  real: ["times real time", "倍实时"],
  good: ["Nothing to complain of", "没有问题"],
  remedy: ["Remedy", "处理"],
  too_long: ["The program is too long for a tab: 50 000 calls and 100 000 pieces of path", "程序太长:标签页最多 50 000 个调用、100 000 段轨迹"],
  message: ["The machine did not understand the page. Load it again", "机床不理解页面的请求,请重新加载"],
  nothing: ["No program is loaded. Press Run", "没有装入程序,请按运行"],
  folder: ["The link names no machine of this page", "链接中的机床不存在"],
  plant: ["This machine cannot be simulated", "无法模拟该机床"],
  alarm: ["The machine's parameters do not fit together", "机床参数不相容"],
  refused_counts: ["The encoder cannot have these counts", "编码器不能用该脉冲数"],
  refused_ripple: ["The spindle cannot have this ripple", "主轴不能有该波动"],
  lost: ["The machine has failed. Load the page again", "机床程序出错,请重新加载页面"],
};

let language = 0;

export const isChinese = () => language === 1;

export function use(zh) {
  language = zh ? 1 : 0;
  document.documentElement.lang = zh ? "zh" : "en";
  for (const one of document.querySelectorAll("[data-word]")) one.textContent = word(one.dataset.word);
}

export function word(key) {
  const words = WORDS[key];
  if (!words) throw new Error(`no words for ${key}`);
  return words[language];
}

// A refusal of the page's machine in words.
export function refusal({ refused, figure }) {
  const key = WORDS[`refused_${refused}`] ? `refused_${refused}` : refused;
  return figure ? `${word(key)} (${figure})` : word(key);
}
