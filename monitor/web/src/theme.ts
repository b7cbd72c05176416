// Light or dark: the system's choice until the user chooses. The user's choice is stored.

const key = 'coppice-theme';
const systemDark = matchMedia('(prefers-color-scheme: dark)');

function kept(): string | null {
  try {
    return localStorage.getItem(key);
  } catch {  // storage is forbidden: use the system's choice
    return null;
  }
}

function keep(theme: string): void {
  try {
    localStorage.setItem(key, theme);
  } catch {
    // the choice is not stored
  }
}

export function isDark(): boolean {
  return document.documentElement.dataset.theme === 'dark';
}

function show(theme: string): void {
  document.documentElement.dataset.theme = theme;
}

export function startTheme(onChange: () => void): void {
  const bySystem = () => show(systemDark.matches ? 'dark' : 'light');
  const choice = kept();
  if (choice === 'dark' || choice === 'light') show(choice);
  else bySystem();
  systemDark.addEventListener('change', () => {
    if (kept()) return;
    bySystem();
    onChange();
  });
}

export function toggleTheme(): void {
  const theme = isDark() ? 'light' : 'dark';
  show(theme);
  keep(theme);
}
