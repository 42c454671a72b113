export function chromium(): string;
export function chromedriver(): string;
export function firefox(): string;
export function webkitDriver(): string;
export function xvfb(): string;
export function flags(): string[];
export function environment(): Record<string, string>;
